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


def run(files, *words):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {"scripts/sentences.txt": "", **files}.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8")
        done = subprocess.run([sys.executable, SCRIPT, *words, folder], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, pathlib.Path(folder, "scripts/sentences.txt").read_text("utf-8")


class Sentences(unittest.TestCase):
    def refused(self, name, text):
        code, output, _ = run({name: text})
        self.assertEqual(code, 1, output)
        self.assertIn(name, output)

    def accepted(self, name, text):
        code, output, _ = run({name: text})
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

    def test_accepts_old_sentences_and_no_new_one(self):
        old = {"docs/a.md": f"{LONG}\n", "scripts/sentences.txt": "1 docs/a.md\n"}
        self.assertEqual(run(old)[0], 0)
        self.assertEqual(run({**old, "docs/a.md": f"{LONG} {LONG}"})[0], 1)

    def test_lets_no_place_for_a_sentence_that_was_mended(self):
        code, output, _ = run({"docs/a.md": "Short.", "scripts/sentences.txt": "1 docs/a.md\n"})
        self.assertEqual(code, 1, output)
        self.assertIn("--keep", output)

    def test_keeps_the_counts_of_today(self):
        self.assertIn("1 docs/a.md", run({"docs/a.md": LONG}, "--keep")[2])


if __name__ == "__main__":
    unittest.main()
