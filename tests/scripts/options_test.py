#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every program of scripts/ says what it takes, refuses what it does not know, and does nothing meanwhile."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCRIPTS = ROOT / "scripts"
# The programs with which scripts change something or that take long. A stand-in notes that it was called, and fails.
AT_WORK = ("apt-get", "sudo", "cmake", "ninja", "ctest", "cpack", "mkdocs", "doxygen", "clang-format", "clang-format-14",
           "clang-tidy", "clang-tidy-14", "aarch64-linux-gnu-g++", "mauved")
# Any word is the name of a FIFO that these make.
ANY_WORD = {"demo.d/joystick.py"}
HELP = {}  # of a script; asked once


def programs():
    """All of them, by their path below scripts/."""
    for path in sorted(SCRIPTS.rglob("*")):
        if not path.is_file() or path.suffix not in ("", ".py") or "__pycache__" in path.parts or path.name == "Doxyfile":
            continue
        text = path.read_text("utf-8")
        if os.access(path, os.X_OK) or 'if __name__ == "__main__"' in text:
            yield path.relative_to(SCRIPTS).as_posix()


class Options(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)
        self.folder = self.place / "folder"
        self.folder.mkdir()
        stand_ins = self.place / "bin"
        stand_ins.mkdir()
        for name in AT_WORK:
            (stand_ins / name).write_text(f"#!/bin/sh\necho {name} \"$@\" >>{self.place}/called\nexit 9\n")
            (stand_ins / name).chmod(0o755)
        self.path = f"{stand_ins}:{os.environ['PATH']}"

    def run_one(self, name, *words):
        """Exit code, standard output and standard error of a script that had nothing to do and did nothing."""
        program = [sys.executable] if name.endswith(".py") else []
        done = subprocess.run([*program, SCRIPTS / name, *words], cwd=self.folder, capture_output=True, text=True, check=False,
                              timeout=60, stdin=subprocess.DEVNULL,
                              env={**os.environ, "PATH": self.path, "PYTHONDONTWRITEBYTECODE": "1"})
        called = self.place / "called"
        self.assertFalse(called.exists(), f"{name} {words} began: {called.read_text() if called.exists() else ''}")
        self.assertEqual(sorted(self.folder.iterdir()), [], f"{name} {words} made files")
        return done.returncode, done.stdout, done.stderr

    def refused(self, name, *words):
        """The one line with which the script refuses the words."""
        code, _, error = self.run_one(name, *words)
        self.assertEqual(code, 2, f"{name} {words}: {error}")
        self.assertEqual(len(error.splitlines()), 1, f"{name} {words}: {error}")
        self.assertIn("--help", error, name)
        return error

    def test_help_prints_what_a_script_takes_and_does_nothing(self):
        for name in programs():
            code, output, error = self.run_one(name, "-h")
            self.assertEqual((code, error), (0, ""), name)
            self.assertEqual(output, self.help_of(name), name)
            self.assertGreater(len(output.splitlines()), 1, f"{name}: {output}")
            self.assertIn(pathlib.Path(name).name, output, name)
            self.assertNotIn("#!", output, name)
            self.assertNotIn("set -", output, name)

    def test_help_names_files_that_are_there(self):
        named = {file for name in programs() for file in re.findall(r"\b(?:libruntime|daemon|examples|docs)/[\w/]+\.\w+", self.help_of(name))}
        self.assertGreater(len(named), 1)
        for file in named:
            self.assertTrue((ROOT / file).is_file(), file)

    def test_an_unknown_option_is_refused(self):
        for name in programs():
            self.assertIn("--nosuch", self.refused(name, "--nosuch"), name)

    def test_an_unknown_option_behind_a_known_one_is_refused(self):
        for name in programs():
            for option in self.options_of(name):
                self.refused(name, option, "--nosuch")

    def test_a_word_that_names_nothing_is_refused(self):
        for name in programs():
            if name not in ANY_WORD:
                self.refused(name, "nosuch")

    def test_an_option_without_its_value_is_refused(self):
        found = 0
        for name in programs():
            for option in self.options_of(name, " [A-Z0-9][A-Z0-9]*\\b"):
                found += 1
                self.assertIn(option, self.refused(name, option), name)
        self.assertGreater(found, 8)

    def test_a_benchmark_or_a_part_that_is_not_there_is_refused(self):
        self.assertIn("nosuch", self.refused("bench", "wake", "nosuch"))
        self.assertIn("nosuch", self.refused("bench", "robot.nosuch"))
        self.assertIn("part", self.refused("bench", "wake.part"))

    def test_a_check_that_looks_at_nothing_fails(self):
        checks = [name for name in programs() if "/" not in name and "[ROOT]" in self.help_of(name)]
        self.assertGreater(len(checks), 7)
        for name in checks:
            code, output, error = self.run_one(name, *(["--check"] if name == "messages.py" else []), str(self.folder))
            self.assertEqual((code, error), (1, ""), f"{name}: {output}")
        self.assertEqual(self.run_one("site.d/links.py", str(self.folder))[0], 1)
        self.assertIn("no C++ file", self.refused("format", "--check", str(ROOT / "README.md")))

    def help_of(self, name):
        if name not in HELP:
            HELP[name] = self.run_one(name, "--help")[1]
        return HELP[name]

    def options_of(self, name, behind=""):
        """The options that the help of a script shows at the begin of a line or behind its name."""
        help_text = self.help_of(name)
        stem = re.escape(pathlib.Path(name).stem)
        return sorted(set(re.findall(rf"(?:^ *|{stem}(?:\.py)? +\[?|\] \[)(--[a-z-]+)(?={behind})", help_text, re.M)) - {"--help"})


if __name__ == "__main__":
    unittest.main()
