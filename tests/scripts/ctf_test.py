#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""babeltrace2 reads what mauvectl writes as CTF.

Usage: ctf_test.py MAUVECTL
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import sample_trace  # noqa: E402


class Ctf(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        file = pathlib.Path(folder.name) / "drive.mtrace"
        cls.records = sample_trace.write(file)
        out = pathlib.Path(folder.name) / "drive"
        made = sample_trace.mauvectl("convert-trace", file, "-o", out)
        assert made.returncode == 0, made.stderr
        read = subprocess.run(["babeltrace2", "--clock-seconds", out], capture_output=True, text=True,
                              check=False)
        assert read.returncode == 0, read.stderr
        cls.warnings = read.stderr
        cls.lines = read.stdout.splitlines()

    def test_has_an_event_for_each_record(self):
        self.assertEqual(len(self.lines), self.records)
        self.assertEqual(self.warnings, "")

    def test_is_in_the_order_of_the_monotonic_clock(self):
        times = [float(line[1:line.index("]")]) for line in self.lines]
        self.assertEqual(times, sorted(times))
        self.assertAlmostEqual(times[0], 1000.000005, places=9)

    def test_names_thread_and_fields(self):
        text = "\n".join(self.lines)
        for expected in (
                'release: { thread = "A" }, { instant_ns = 60000000, change = 1 }',
                'commit: { thread = "[control]" }, { what = "core.swap A", instant_ns = 60000000, change = 1 }',
                'member: { thread = "[control]" }, { component = "A", change = 1 }',
                'user: { thread = "B" }, { name = "gain", value = 0.25 }',
                'end: { thread = "A" }, { state = "work", preempted = 1 }'):
            self.assertIn(expected, text)


if __name__ == "__main__":
    if shutil.which("babeltrace2") is None:
        sample_trace.skip("babeltrace2 is not installed; scripts/setup installs it")
    unittest.main()
