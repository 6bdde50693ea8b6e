#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The checker of printed commands (scripts/commands.py) refuses what it says, and lists what a test runs."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "commands.py"


def check(text, *words, files=()):
    """Exit code and output for a tree of one page, docs/page.md, and other files."""
    with tempfile.TemporaryDirectory() as root:
        for name, content in {"docs/page.md": text, **dict(files)}.items():
            path = pathlib.Path(root) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content, "utf-8")
        done = subprocess.run([sys.executable, SCRIPT, *words, root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr


BLOCK = "```sh\nmauvectl status\n```\n"


class Commands(unittest.TestCase):
    def refused(self, text, words, **more):
        code, output = check(text, **more)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def test_refuses_a_block_without_a_mark(self):
        for block in (BLOCK, "```bash\ntrue\n```\n", "```\nmauvectl status\n```\n", "```text\n$ mauvectl doctor\n...\n```\n",
                      "- item:\n  ```sh\n  true\n  ```\n", "```\nscripts/setup\n```\n", "```\nsudo apt install x\n```\n"):
            self.refused(block, "it has no mark")
        self.refused("\n" + BLOCK, "docs/page.md:2: ")

    def test_refuses_a_mark_that_it_does_not_know(self):
        for mark in ("<!-- runs -->", "<!-- not run -->", "<!-- not run: -->", "<!-- run by -->"):
            self.refused(f"{mark}\n{BLOCK}", "is none of those")

    def test_accepts_each_mark(self):
        for mark in ("<!-- run -->", "<!-- run after: cd x -->", "<!-- not run: it restarts the machine -->"):
            self.assertEqual(check(f"{mark}\n{BLOCK}")[0], 0, mark)
        for mark in ("<!-- run by tests/a.py -->", "<!-- compared by tests/a.py -->"):
            self.assertEqual(check(f"{mark}\n{BLOCK}", files={"tests/a.py": "read('docs/page.md')"})[0], 0, mark)

    def test_refuses_a_test_that_is_not_there_or_reads_another_page(self):
        self.refused(f"<!-- run by tests/a.py -->\n{BLOCK}", "tests/a.py is not there")
        self.refused(f"<!-- run by tests/a.py -->\n{BLOCK}", "does not name this page", files={"tests/a.py": "other.md"})

    def test_reads_no_data_and_no_output(self):
        self.assertEqual(check("```json\n{}\n```\n```\nviolated: control\n```\n```console\n$ true\n```\n")[0], 0)

    def test_lists_what_runs_each_block_and_the_pages_of_the_harness(self):
        code, output = check("```console\n$ true\n```\n<!-- not run: it waits -->\n" + BLOCK, "--list")
        self.assertEqual((code, output.splitlines()), (0, [
            "docs/page.md:1: run as printed by tests/external/page_test.py", "docs/page.md:5: not run, because it waits"]))
        self.assertEqual(check("```console\n$ true\n```\n", "--pages"), (0, "docs/page.md docs/how-to/README.md\n"))
        self.assertEqual(check("<!-- not run: it waits -->\n```console\n$ true\n```\n", "--pages"), (0, "\n"))


if __name__ == "__main__":
    unittest.main()
