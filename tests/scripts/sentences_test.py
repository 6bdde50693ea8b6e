#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The rules of sentences refuse what they should, and nothing else."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/sentences.py"
LONG = "The task " + "waits and " * 15 + "runs."


def run(files):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8")
        done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


class Sentences(unittest.TestCase):
    def refused(self, name, text):
        code, output = run({name: text})
        self.assertEqual(code, 1, output)
        self.assertIn(name, output)

    def accepted(self, name, text):
        code, output = run({name: text})
        self.assertEqual(code, 0, output)

    def test_refuses_a_long_sentence_of_a_document(self):
        self.refused("docs/a.md", LONG)

    def test_refuses_a_long_sentence_over_the_lines_of_a_comment(self):
        self.refused("ctl/a.cpp", "/// " + LONG.replace("runs.", "\n/// runs.") + "\nint a;\n")

    def test_refuses_a_long_sentence_behind_code(self):
        self.refused("ctl/a.h", f"int a;  // {LONG}\n")

    def test_refuses_a_subject_that_is_no_noun(self):
        self.refused("docs/a.md", "The job ends. What it holds is free.")
        self.refused("ctl/a.cpp", "/// Who waits is woken.\n")

    def test_accepts_a_question(self):
        self.accepted("docs/a.md", "What does it hold?")

    def test_counts_neither_code_nor_the_words_of_a_name(self):
        self.accepted("docs/a.md", f"```\n{LONG}\n```\n")
        self.accepted("docs/a.md", "The file `" + "a " * 40 + "` is there.")
        self.accepted("docs/a.md", "[What mauve is](README.md) comes first.")
        self.accepted("ctl/a.cpp", f'const char* a = "https://{LONG}";\n')


if __name__ == "__main__":
    unittest.main()
