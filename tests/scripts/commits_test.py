#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The rules of commits are checked on made-up histories."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "commits.py"
NAME = ["-c", "user.name=Test", "-c", "user.email=test@example.org"]


class Commits(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.git("init", "-q")

    def git(self, *words):
        subprocess.run(["git", *NAME, *words], cwd=self.folder.name, check=True, capture_output=True,
                       env={"PATH": "/usr/bin:/bin", "GIT_COMMITTER_DATE": "2020-02-02T12:00:00+00:00"})

    def commit(self, message, lines=1):
        text = "".join(f"{message.splitlines()[0]} {at}\n" for at in range(lines))
        (pathlib.Path(self.folder.name) / "file").write_text(text, "utf-8")
        self.git("add", "-A")
        self.git("commit", "-q", "-m", message)

    def check(self, first_date="2000-01-01"):
        done = subprocess.run([sys.executable, SCRIPT, self.folder.name, first_date], capture_output=True, text=True,
                              check=False)
        return done.returncode, done.stdout + done.stderr

    def refused(self, words):
        code, output = self.check()
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def test_accepts_a_short_subject_of_one_idea(self):
        self.commit("exec: hold the grid over a slow configure")
        self.assertEqual(self.check(), (0, "commits: 1 keep the rules\n"))

    def test_refuses_a_long_subject(self):
        self.commit("exec: " + "x" * 59)
        self.assertEqual(self.check()[0], 0)
        self.commit("exec: " + "x" * 60)
        self.refused("its subject has 66 characters, the limit is 65")

    def test_refuses_several_ideas(self):
        self.commit("exec: hold the grid; rename the barrier")
        self.refused("joins several ideas")

    def test_refuses_a_subject_without_an_area(self):
        self.commit("hold the grid")
        self.refused("names no area")

    def test_refuses_a_large_change_that_says_no_reason(self):
        self.commit("exec: hold the grid\n\nA slow configure moved it.", lines=200)
        self.assertEqual(self.check()[0], 0)
        self.commit("exec: hold it again", lines=101)
        self.refused("301 lines and has no body")

    def test_leaves_what_is_older_than_the_rule_alone(self):
        self.commit("exec: hold the grid; rename the barrier")
        self.assertEqual(self.check("2020-02-03"), (77, "commits: skipped, there is no commit to judge\n"))

    def test_does_not_judge_the_end_of_a_shallow_clone(self):
        self.commit("exec: hold the grid")
        self.commit("exec: hold it again", lines=200)
        with tempfile.TemporaryDirectory() as folder:
            self.git("clone", "-q", "--depth=1", f"file://{self.folder.name}", f"{folder}/clone")
            done = subprocess.run([sys.executable, SCRIPT, f"{folder}/clone", "2000-01-01"], capture_output=True,
                                  text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (77, "commits: skipped, there is no commit to judge\n"))

    def test_says_that_it_skips_where_there_is_no_history(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 77)
        self.assertIn("commits: skipped", done.stdout)


if __name__ == "__main__":
    unittest.main()
