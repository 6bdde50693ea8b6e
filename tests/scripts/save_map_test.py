#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""A map that mauvectl prints is saved as the files it came from; what is no map is refused."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

MAPS = pathlib.Path(__file__).resolve().parents[2] / "etc" / "maps"
CELLS = {254: 0, 205: -1, 0: 100}


def save(text, file):
    return subprocess.run([sys.executable, MAPS / "save_map.py", file], input=text, text=True,
                          capture_output=True, check=False)


class SaveMap(unittest.TestCase):
    def test_gives_back_the_files_it_came_from(self):
        image = (MAPS / "building.pgm").read_bytes()
        levels = image[-480 * 320:]
        cells = [CELLS[level] for row in reversed(range(320)) for level in levels[row * 480:(row + 1) * 480]]
        answer = {"value": {"width": 480, "height": 320, "cells": cells, "resolution": 0.05, "time": 1.5,
                            "origin": {"x": -4.0, "y": -5.0, "heading": 0}}}
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "building.yaml"
            self.assertEqual(save(json.dumps(answer), file).returncode, 0)
            self.assertEqual(file.read_text(), (MAPS / "building.yaml").read_text())
            self.assertEqual(file.with_suffix(".pgm").read_bytes(), image)

    def test_refuses_what_is_no_map(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "map.yaml"
            for text in ("", "[]", '{"error": 1}', '{"value": null}',
                         '{"value": {"width": 2, "height": 2, "cells": [0], "origin": {}}}'):
                self.assertNotEqual(save(text, file).returncode, 0, text)
            self.assertNotEqual(save("{}", file.with_suffix(".pgm")).returncode, 0)
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [])


if __name__ == "__main__":
    unittest.main()
