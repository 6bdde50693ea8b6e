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
REFUSALS = '// ## Files\nMAUVE_REFUSAL(file_gone, system, unchanged, "It is "\n              "gone.", "Look for it.")\n'
CODE = 'return refuse({Errc::system, "file_gone"}, path, "is gone");\n'


class Messages(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.write("daemon/log/events.def", EVENTS)
        self.write("daemon/protocol/errors.def", ERRORS)
        self.write("daemon/protocol/refusals.def", REFUSALS)
        self.write("daemon/files.cpp", CODE)
        self.write("daemon/begin.cpp", "log.write(Event::begun)")
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
        self.assertIn("| `file_gone` | system | It is gone. | Look for it. |", page)
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

    def refused(self, code, words):
        self.run_script()
        self.write("daemon/files.cpp", code)
        done, output = self.run_script("--check")
        self.assertEqual(done, 1, output)
        self.assertIn(words, output)

    def test_refuses_a_refusal_without_a_row(self):
        self.refused(CODE + 'refuse({Errc::system, "file_lost"}, path, "is lost");\n', "has no row of kind system")

    def test_refuses_a_refusal_of_another_kind_than_its_row(self):
        self.refused(CODE + 'error.code = Errc::limit;\nerror.id = "file_gone";\n', "has no row of kind limit")

    def test_refuses_a_row_without_a_use(self):
        self.refused("", 'nothing refuses with "file_gone"')

    def test_refuses_an_event_that_nothing_logs(self):
        self.write("daemon/begin.cpp", "// no event")
        self.refused(CODE, "nothing logs the event begun")

    def test_refuses_a_refusal_without_a_name(self):
        self.refused(CODE + 'refuse(Errc::system, path, "is lost");\n', "1 refusals without a name")

    def test_refuses_a_wrong_use_without_a_row(self):
        self.refused(CODE + 'return wrong_use(\n    "usage_word", text);\n', '"usage_word" has no row of kind usage')

    def test_refuses_a_wrong_use_without_a_name(self):
        self.refused(CODE + 'return fault_of(protocol::kUsage, text);\n', "1 refusals without a name")
        self.refused(CODE + "return wrong_use(text);\n", "1 refusals without a name")

    def test_lets_a_wrong_use_be_named_and_passed_on(self):
        self.write("daemon/protocol/refusals.def", REFUSALS + 'MAUVE_REFUSAL(usage_word, usage, unsent, "It is '
                   'none.", "Look.")\n')
        self.write("daemon/files.cpp", CODE + 'wrong_use("usage_word", text); wrong_use(error.id, error.message);\n')
        self.assertEqual(self.run_script()[0], 0)
        page = (self.root / "docs/messages.md").read_text("utf-8")
        self.assertIn("| `usage_word` | usage | It is none. Nothing was sent to mauved. | Look. |", page)

    def test_refuses_two_messages_of_one_name(self):
        self.write("daemon/protocol/errors.def", ERRORS + 'MAUVE_ERROR(file_gone, "It is gone.", "Look.")\n')
        self.refused(CODE, "two messages have this name")

    def test_lets_a_kind_be_compared_printed_and_passed_on(self):
        self.run_script()
        self.write("daemon/files.cpp", CODE + "case Errc::limit: return a == Errc::system ? to_string(Errc::limit) : "
                   "refuse(reason_of(error), at, text); // refuse(Errc::limit)\n")
        self.assertEqual(self.run_script("--check")[0], 0)


if __name__ == "__main__":
    unittest.main()
