#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The page of messages is the one that the tables make, and no row of a table is lost."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/messages.py"
EVENTS = '// 01xx  the daemon\nMAUVE_EVENT(0x0101, begun, info, "begins {file}",\n            "The first "\n            "line.")\n'
ERRORS = 'MAUVE_ERROR(cycle, "They wait.", "Cut it.")\nMAUVE_FAILURE(threw, "It threw.", "Look.")\n'


class Messages(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.write("daemon/log/events.def", EVENTS)
        self.write("daemon/protocol/errors.def", ERRORS)
        self.write("docs/messages.md", "")

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")

    def run_script(self, *words):
        done = subprocess.run([sys.executable, SCRIPT, *words, self.root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    def test_has_each_message_of_the_tables(self):
        self.assertEqual(self.run_script()[0], 0)
        page = (self.root / "docs/messages.md").read_text("utf-8")
        self.assertIn("| `begun` | info | `begins {file}` | The first line. |", page)
        self.assertIn("| `cycle` | They wait. | Cut it. |", page)
        self.assertIn("| `threw` | It threw. | Look. |", page)
        self.assertEqual(self.run_script("--check")[0], 0)

    def test_refuses_a_page_that_is_older_than_a_table(self):
        self.run_script()
        self.write("daemon/protocol/errors.def", ERRORS + 'MAUVE_ERROR(limit, "Too much.", "Send less.")\n')
        code, output = self.run_script("--check")
        self.assertEqual(code, 1, output)
        self.assertIn("scripts/messages.py writes it", output)

    def test_refuses_a_row_that_it_cannot_read(self):
        self.write("daemon/protocol/errors.def", ERRORS + "MAUVE_ERROR(limit, kText, kAdvice)\n")
        code, output = self.run_script()
        self.assertEqual(code, 1, output)
        self.assertIn("could be read", output)


if __name__ == "__main__":
    unittest.main()
