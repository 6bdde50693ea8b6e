#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""scripts/site leads the links of documents into the site, and refuses those that lead nowhere or to the network."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
CONFIG = f"""site_name: trial
docs_dir: docs
site_dir: build/site
use_directory_urls: false
theme:
  name: material
  font: false
hooks: [{SCRIPTS}/site.d/hooks.py]
nav:
  - README.md
  - Tutorial: tutorial/
  - Benchmarks: benchmarks.md?
"""
SKIPPED = 77


class Site(unittest.TestCase):
    def build(self, text, **more):
        """Builds a tree whose index has this text; the result is the exit code, the output and the pages."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            files = {"mkdocs.yml": CONFIG, "docs/README.md": f"# Index\n\n{text}\n", "ARCHITECTURE.md": "# Map\n\n## Way\n",
                     "daemon/main.cpp": "int main() {}\n", **more}
            for name, content in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(content, "utf-8")
            done = subprocess.run([SCRIPTS / "site", "--root", root], capture_output=True, text=True, check=False)
            pages = {at.relative_to(root / "build/site").as_posix(): at.read_text("utf-8")
                     for at in (root / "build/site").rglob("*.html")}
            return done.returncode, done.stdout + done.stderr, pages

    def test_leads_links_to_pages_of_documents_and_sources(self):
        code, output, pages = self.build("[map](../ARCHITECTURE.md#way), [main](../daemon/main.cpp), [all](../daemon):\n- one",
                                         **{"docs/tutorial/first.md": "# First\n"})
        self.assertEqual(code, 0, output)
        self.assertIn('href="source/ARCHITECTURE.html#way"', pages["index.html"])
        self.assertIn('href="source/daemon/main.cpp.html"', pages["index.html"])
        self.assertIn("<li>one</li>", pages["index.html"])
        self.assertIn("main", pages["source/daemon/main.cpp.html"])
        self.assertIn('href="tutorial/first.html"', pages["index.html"])

    def test_begins_a_table_after_text_and_after_code(self):
        table = "| a | b |\n|---|---|\n| 1 | 2 |"
        code, output, pages = self.build(f"Text:\n{table}\n\n```\ncode\n```\n{table}")
        self.assertEqual(code, 0, output)
        self.assertEqual(pages["index.html"].count("<table>"), 2)

    def test_refuses_a_table_that_is_shown_as_raw_text(self):
        code, output, _ = self.build("Text:\n    \n  | a | b |\n  |---|---| c\n")
        self.assertEqual(code, 1)
        self.assertIn("index.html: a table is shown as raw text", output)

    def test_refuses_a_page_that_the_navigation_leaves_out(self):
        code, output, _ = self.build("Text.", **{"docs/concepts/new.md": "# New\n"})
        self.assertEqual(code, 1)
        self.assertIn("concepts/new.md has no place in the navigation", output)

    def test_refuses_a_page_that_is_not_there(self):
        code, output, _ = self.build("[gone](../daemon/gone.cpp)")
        self.assertEqual(code, 1)
        self.assertIn("gone.cpp", output)

    def test_refuses_an_anchor_that_is_not_there_and_an_image_of_the_network(self):
        code, output, _ = self.build("[map](../ARCHITECTURE.md#gone) ![far](https://example.org/far.png)")
        self.assertEqual(code, 1)
        self.assertIn("source/ARCHITECTURE.html#gone: that page has no such anchor", output)
        self.assertIn("loads https://example.org/far.png from the network", output)


if __name__ == "__main__":
    missing = [tool for tool in ("mkdocs", "doxygen") if shutil.which(tool) is None]
    if missing:
        print(f"skipped: {' '.join(missing)} is missing: apt-get install mkdocs mkdocs-material doxygen")
        sys.exit(SKIPPED)
    unittest.main()
