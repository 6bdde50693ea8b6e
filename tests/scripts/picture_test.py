#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The picture of the demo shows what was driven."""
import pathlib
import sys
import unittest
import xml.dom.minidom

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts" / "demo.d"))
import picture  # noqa: E402

PATH = [(0.0, 0.0, "a/one"), (1.0, 0.5, "a/one"), (2.0, 1.0, "a/two"), (3.0, 1.0, "a/two")]
OBSTACLES = [(1.5, -1.0, 0.5)]
GOAL = (3.0, 1.0)


class Picture(unittest.TestCase):
    def test_a_line_for_each_core_that_begins_where_the_last_one_ended(self):
        self.assertEqual(picture.pieces(PATH),
                         [("a/one", [(0.0, 0.0), (1.0, 0.5)]),
                          ("a/two", [(1.0, 0.5), (2.0, 1.0), (3.0, 1.0)])])

    def test_the_svg_is_well_formed_and_has_everything(self):
        root = xml.dom.minidom.parseString(picture.svg(PATH, OBSTACLES, GOAL))
        self.assertEqual(len(root.getElementsByTagName("polyline")), 2)
        self.assertEqual(len(root.getElementsByTagName("circle")), 3)

    def test_the_text_shows_start_goal_obstacle_and_both_cores(self):
        text = picture.text(PATH, OBSTACLES, GOAL)
        for mark in "SG#12":
            self.assertIn(mark, text.rsplit("\n", 1)[0])
        self.assertIn("2 a/two", text)

    def test_a_robot_that_never_moved_has_a_picture_too(self):
        self.assertIn("G", picture.text([], OBSTACLES, GOAL))
        xml.dom.minidom.parseString(picture.svg([], OBSTACLES, GOAL))


if __name__ == "__main__":
    unittest.main()
