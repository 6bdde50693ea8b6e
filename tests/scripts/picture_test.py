#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The picture of the demo shows what was driven."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts" / "demo.d"))
import picture  # noqa: E402

# Four metres square, a wall along the upper edge.
GRID = {"resolution": 0.1, "width": 40, "height": 40, "origin": {"x": -1.0, "y": -2.0},
        "cells": [0] * (40 * 38) + [100] * 80}
PATH = [(0.0, 0.0, "a/one"), (1.0, 0.5, "a/one"), (2.0, 1.0, "a/two"), (2.5, 1.0, "a/two")]
GOAL = (2.5, 1.0)


def drawn(path):
    *rows, legend = picture.text(GRID, path, GOAL, 20).split("\n")
    return rows, legend


class Picture(unittest.TestCase):
    def test_shows_start_goal_wall_and_both_cores(self):
        rows, legend = drawn(PATH)
        for mark in "SG#12":
            self.assertIn(mark, "".join(rows))
        self.assertIn("2 a/two", legend)

    def test_has_its_upper_edge_on_top_and_x_to_the_right(self):
        rows, _ = drawn(PATH)
        self.assertEqual(rows[0], "#" * 20)
        self.assertEqual(rows[4].index("S"), 5)
        self.assertEqual(rows[2].index("G"), 17)

    def test_of_a_robot_that_never_moved_has_its_goal(self):
        rows, _ = drawn([])
        self.assertIn("G", "".join(rows))

    def test_a_way_off_the_map_stays_at_its_edge(self):
        rows, _ = drawn([(-9.0, 9.0, "a/one"), (9.0, -9.0, "a/one")])
        self.assertEqual(rows[0][0], "S")
        self.assertEqual(rows[-1][-1], "1")


if __name__ == "__main__":
    unittest.main()
