#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""scripts/named_files.py finds files and functions that a document names and that are not there."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "named_files.py"


class NamedFiles(unittest.TestCase):
    def check(self, text, name="ARCHITECTURE.md", source="void Here::run() {}\n"):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "daemon").mkdir()
            (root / "daemon" / "there.cpp").write_text(source)
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
            done = subprocess.run([sys.executable, SCRIPT, root], capture_output=True, text=True, check=False)
            return done.returncode, done.stdout

    def test_accepts_files_and_functions_that_are_there(self):
        self.assertEqual(self.check("`Here::run()`, `daemon/there.cpp`, runs.")[0], 0)

    def test_refuses_a_file_that_is_not_there(self):
        code, output = self.check("See `daemon/gone.cpp`.")
        self.assertEqual(code, 1)
        self.assertIn("daemon/gone.cpp is not there", output)

    def test_refuses_a_function_that_its_file_does_not_have(self):
        code, output = self.check("`Here::walk()`,\n`daemon/there.cpp`, walks.")
        self.assertEqual(code, 1)
        self.assertIn("has no Here::walk()", output)

    def test_refuses_a_comment_that_names_a_file_that_is_not_there(self):
        code, output = self.check("", source="/// Its lock: see gate.h.\nint x;  // see daemon/there.cpp\n")
        self.assertEqual(code, 1)
        self.assertIn("daemon/there.cpp:1: gate.h is not there", output)
        self.assertEqual(output.count("not there"), 1)

    def test_does_not_read_documents_of_the_past(self):
        self.assertEqual(self.check("`daemon/gone.cpp`", "docs/decisions/0001-past.md")[0], 0)


if __name__ == "__main__":
    unittest.main()
