#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a page prints commands and does not say what runs them.

Usage: commands.py [ROOT]            prints one line for each violation: page:line: what, and what to do instead
       commands.py --list [ROOT]     prints each block of commands with what runs it
       commands.py --pages [ROOT]    prints the pages that tests/external/page_test.py runs, each with its index

A block ```console is run as printed, and its output is compared: each page that has one is a test. Any other block of
commands has one of these marks above it, which no reader of the page sees:
  <!-- run -->               page_test.py runs each line as printed, and it must succeed
  <!-- run after: LINE -->   the same, after this line, which the page does not show
  <!-- run by FILE -->       this test reads the page and runs the block as printed
  <!-- compared by FILE -->  this test reads the page and compares the block with what the program prints
  <!-- not run: REASON -->   nothing runs it, for this reason
"""
import pathlib
import re
import sys

import command_line

FENCE = re.compile(r"^(?P<mark><!--[^\n]*-->\n)?(?P<indent> *)```(?P<info>[^\n]*)\n(?P<text>.*?)^(?P=indent)```[ \t]*$", re.M | re.S)
MARK = re.compile(r"<!-- (?:(run)(?: after: [^\n]+)?|(run|compared) by (\S+)|not run: (\S.*\S)) -->\n")
SHELLS = ("sh", "bash", "shell", "console")
DATA = ("cpp", "c", "json", "xml", "yaml", "cmake", "diff", "ini", "python", "lua")
# A block without a language has commands if a line of it begins with one of these words.
PROGRAM = re.compile(r"^(?:\$ |(?:sudo |\S*/)?(?:mauved|mauvectl|mauve-guardian|mauve-stamp|cmake|ctest|apt|apt-get|systemctl|"
                     r"journalctl|gdb|git|scripts/\w+)(?: |$))", re.M)
PAST = ("CHANGELOG.md", "docs/decisions/")
# The page whose blocks prepare the shell of the pages below a folder; the first that fits.
INDEXES = {"examples/": "examples/README.md", "docs/tutorial/": "docs/tutorial/README.md", "": "docs/how-to/README.md"}


class Block:
    """A block of commands of a page."""

    def __init__(self, root, page, text, found):
        mark = MARK.fullmatch(found["mark"] or "")
        self.root, self.page = root, page
        self.line = text.count("\n", 0, found.start("info")) + 1
        self.language = found["info"].split(" ")[0]
        self.is_marked = bool(found["mark"])
        self.runs, self.how, self.test, self.reason = mark.groups() if mark else (None,) * 4

    def by_page_test(self):
        return self.language == "console" and not self.reason or bool(self.runs)

    def said(self):
        """What runs the block, in words."""
        if self.reason:
            return f"not run, because {self.reason}"
        if self.test:
            return f"{'run as printed' if self.how == 'run' else 'compared'} by {self.test}"
        return "run as printed by tests/external/page_test.py" if self.by_page_test() else "?"

    def problem(self):
        if self.said() == "?":
            what = "its mark is none of those that scripts/commands.py --help lists" if self.is_marked else "it has no mark"
            return f"{what}; write which test runs or compares these commands, or why none does"
        if self.test and not (self.root / self.test).is_file():
            return f"{self.test} is not there; name the test that runs or compares these commands"
        if self.test and pathlib.PurePath(self.page).name not in (self.root / self.test).read_text("utf-8"):
            return f"{self.test} does not name this page; name the test that reads it"
        return None


def pages(root):
    # Not below build/, which the check of the site writes meanwhile.
    folders = [folder for folder in root.iterdir() if folder.is_dir() and folder.name not in ("build", ".git")]
    paths = [*root.glob("*.md"), *(path for folder in folders for path in folder.rglob("*.md"))]
    names = [path.relative_to(root).as_posix() for path in paths]
    return sorted(name for name in names if not name.startswith(PAST) and "/build/" not in name)


def blocks(root):
    for page in pages(root):
        text = (root / page).read_text("utf-8")
        for found in FENCE.finditer(text):
            language = found["info"].split(" ")[0]
            if language in SHELLS or language not in DATA and PROGRAM.search(found["text"]):
                yield Block(root, page, text, found)


def index_of(page):
    return next(index for folder, index in INDEXES.items() if page.startswith(folder))


def main():
    arguments = command_line.tree(__doc__, "--list", "--pages")
    found = list(blocks(arguments.root))
    if arguments.list:
        print("\n".join(f"{one.page}:{one.line}: {one.said()}" for one in found))
    if arguments.pages:
        print("\n".join(f"{page} {index_of(page)}" for page in sorted({one.page for one in found if one.by_page_test()})))
    if arguments.list or arguments.pages:
        return 0 if found else 1
    problems = [f"{one.page}:{one.line}: {one.problem()}" for one in found if one.problem()]
    ways = {way: sum(one.said().startswith(way) for one in found) for way in ("run as printed", "compared", "not run")}
    return command_line.result(found, problems, "commands: " + ", ".join(f"{count} {way}" for way, count in ways.items()))


if __name__ == "__main__":
    sys.exit(main())
