#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""member_names_test.py PREFIX: a member that is registered under another name fails an author's build with one sentence."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parent / "project"
prefix = ""


class MemberNames(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mauve_names_")).resolve()
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copytree(PROJECT, self.folder / "blink")
        self.run_cmake("-S", "blink", "-B", "build", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Debug")

    def run_cmake(self, *arguments, good=True):
        done = subprocess.run(["cmake", *arguments], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False)
        self.assertEqual(done.returncode == 0, good, done.stdout)
        return done.stdout

    def change(self, old, new):
        file = self.folder / "blink" / "blink.h"
        text = file.read_text(encoding="utf-8")
        self.assertEqual(text.count(old), 1)
        file.write_text(text.replace(old, new), encoding="utf-8")
        return f"{file}:{text[:text.index(old)].count(chr(10)) + 1}: "

    def test_a_wrong_name_in_a_header_fails_the_build_until_it_is_right_or_meant(self):
        place = self.change('brightness{*this, "brightness"', 'brightness{*this, "brihgtness"')
        output = self.run_cmake("--build", "build", good=False)
        sentences = [line for line in output.splitlines() if line.startswith(str(self.folder)) and ": error: " in line]
        self.assertEqual(sentences, [place + 'error: member brightness is registered as "brihgtness"; give both one name, '
                                     'or put a comment before the string if another name is meant'])
        self.assertFalse(list(self.folder.glob("build/**/blink.so")))
        self.change('"brihgtness"', '/*on the wire*/ "brihgtness"')
        self.run_cmake("--build", "build")
        self.assertTrue(list(self.folder.glob("build/**/blink.so")))


if __name__ == "__main__":
    prefix = os.path.abspath(sys.argv.pop())
    unittest.main()
