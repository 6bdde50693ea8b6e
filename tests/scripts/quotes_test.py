#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""scripts/quotes.py finds blocks of pages that quote a file otherwise than it is."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "quotes.py"
SOURCE = "struct A {\n  int x = 1;\n\n  int y = 2;\n  int z = 3;\n};\n"


class Quotes(unittest.TestCase):
    def check(self, block, name="examples/a.h"):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for inner in ("docs", "examples"):
                (root / inner).mkdir()
            (root / "examples" / "a.h").write_text(SOURCE)
            (root / "docs" / "page.md").write_text(f'# Page\n\n```cpp title="{name}"\n{block}\n```\n')
            done = subprocess.run([sys.executable, SCRIPT, root], capture_output=True, text=True, check=False)
            return done.returncode, done.stdout

    def test_accepts_lines_of_the_file(self):
        self.assertEqual(self.check("  int x = 1;\n\n  int y = 2;")[0], 0)

    def test_accepts_lines_without_their_common_indentation(self):
        self.assertEqual(self.check("int y = 2;\nint z = 3;")[0], 0)

    def test_accepts_lines_left_out_where_the_page_says_so(self):
        self.assertEqual(self.check("struct A {\n  // ...\n  int z = 3;\n};")[0], 0)

    def test_refuses_a_line_that_differs(self):
        code, output = self.check("int y = 4;")
        self.assertEqual(code, 1)
        self.assertIn("docs/page.md:3: examples/a.h: has not the lines that begin with 'int y = 4;'", output)

    def test_refuses_lines_left_out_silently(self):
        self.assertEqual(self.check("int x = 1;\nint z = 3;")[0], 1)

    def test_refuses_lines_in_another_order(self):
        self.assertEqual(self.check("int y = 2;\n// ...\nint x = 1;")[0], 1)

    def test_refuses_a_file_that_is_not_there(self):
        self.assertIn("examples/b.h: is not there", self.check("int x = 1;", "examples/b.h")[1])


if __name__ == "__main__":
    unittest.main()
