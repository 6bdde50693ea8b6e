#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Players of a recording take the place of the drivers of an architecture, and mauved accepts the result."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ETC = pathlib.Path(__file__).resolve().parents[2] / "etc"
HEADER = "time_s,odometry.read.time,odometry.read.x,goal.read.x,goal.read.y,gnss.core.satellites\n"
MAUVED, PLUGINS = sys.argv.pop(1), sys.argv.pop(1)


def play(folder, header=HEADER, *more, text=None):
    """rover.json beside a recording in the folder, and the result of the tool."""
    text = (text or (ETC / "rover.json").read_text()).replace("maps/building.yaml", str(ETC / "maps" / "building.yaml"))
    (folder / "rover.json").write_text(text)
    (folder / "drive.csv").write_text(header)
    command = [sys.executable, ETC / "samples" / "play.py", "rover.json", "drive.csv", "-o", "played.json", *more]
    return subprocess.run(command, cwd=folder, text=True, capture_output=True, check=False)


class Play(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def played(self, *more, header=HEADER, text=None):
        done = play(self.folder, header, *more, text=text)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.folder / "played.json").read_text())

    def test_leaves_out_who_writes_what_is_played(self):
        components = self.played()["components"]
        self.assertNotIn("base", components)
        self.assertNotIn("mission", components)
        self.assertEqual(components["play_odometry"]["type"], "drivers/playback_odometry")
        self.assertEqual(components["play_odometry"]["ports"], {"out": "odometry.write"})
        self.assertEqual(components["play_odometry"]["properties"]["core.address"], "odometry.read")
        self.assertEqual(components["play_goal"]["type"], "drivers/playback_point2d")

    def test_keeps_a_component_but_for_its_connection(self):
        base = self.played("--keep", "base")["components"]["base"]
        self.assertNotIn("odometry", base["ports"])
        self.assertIn("twist", base["ports"])

    def test_leaves_out_rules_and_transactions_that_name_what_is_gone(self):
        before = self.played()
        self.assertIn("drop_gnss", before["transactions"])
        # The fix goes through a shared_data here, so that it can be recorded and played.
        text = (ETC / "rover.json").read_text().replace('"fix": "gnss_to_utm.fix"', '"fix": "fix.write"')
        text = text.replace('"goal":         {', '"fix": { "type": "shared_data", "data": "gnss_fix/1" }, "goal": {')
        system = self.played(header="time_s,fix.read.time\n", text=text)
        self.assertNotIn("gnss", system["components"])
        self.assertEqual([name for name in system["transactions"] if "gnss" in name], [])
        self.assertEqual([rule["name"] for rule in system["rules"]],
                         ["in_the_yard", "in_the_building", "does_not_get_on", "base_disobeys"])

    def test_is_accepted_by_mauved(self):
        self.played()
        (self.folder / "drive.csv").write_text(HEADER + "1.0,1.0,2.0,3.0,4.0,9\n")
        checked = subprocess.run([MAUVED, "--check", "played.json", "--plugin-dir", PLUGINS, "--allow-path", ETC],
                                 cwd=self.folder, text=True, capture_output=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def test_names_a_player_for_a_type_of_the_user(self):
        header = "time_s,map.read.width\n"
        done = play(self.folder, header)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("--kind occupancy_grid/1=", done.stderr)
        system = self.played("--kind", "occupancy_grid/1=mine/player", header=header)
        self.assertEqual(system["components"]["play_map"]["type"], "mine/player")
        self.assertIn("mine", system["plugins"])

    def test_refuses_a_file_of_other_addresses(self):
        done = play(self.folder, "time_s,other.read.x\n")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no column of a shared_data", done.stderr)


if __name__ == "__main__":
    unittest.main()
