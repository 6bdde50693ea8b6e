#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a page of docs/ quotes a file, and the file has another text.

Usage: quotes.py [ROOT]    prints one line for each violation: page:line: file: what

A block that quotes a file names it by its path in the project: ```cpp title="examples/core/homing.h". Its lines are lines
of the file one below the other, with any indentation in common. A line "// ..." in the block stands for lines left out.
"""
import re
import sys
import textwrap

import command_line

BLOCK = re.compile(r'^```\w+ title="([\w./-]+)"\n(.*?)^```$', re.M | re.S)
LEFT_OUT = "// ..."


def parts(block):
    """The runs of lines between those that stand for lines left out."""
    run = []
    for line in textwrap.dedent(block).splitlines():
        if line.strip() == LEFT_OUT:
            yield run
            run = []
        else:
            run.append(line.rstrip())
    yield run


def place(lines, run, begin):
    """The index behind the first occurrence of the run; None: there is none."""
    wanted = textwrap.dedent("\n".join(run))
    for at in range(begin, len(lines) - len(run) + 1):
        if textwrap.dedent("\n".join(lines[at:at + len(run)])) == wanted:
            return at + len(run)
    return None


def missing(block, text):
    """The first line of the first run that the text does not have; None: it has all of them, in their order."""
    lines, at = [line.rstrip() for line in text.splitlines()], 0
    for run in filter(None, parts(block)):
        at = place(lines, run, at)
        if at is None:
            return run[0].strip()
    return None


def problems(root):
    for page in sorted((root / "docs").rglob("*.md")):
        text = page.read_text("utf-8")
        for match in BLOCK.finditer(text):
            name, block = match.groups()
            where = f"{page.relative_to(root).as_posix()}:{text.count(chr(10), 0, match.start()) + 1}: {name}"
            if not (root / name).is_file():
                yield f"{where}: is not there; name the file that is quoted"
            elif (line := missing(block, (root / name).read_text("utf-8"))) is not None:
                yield f"{where}: has not the lines that begin with '{line}'; quote it as it is"


def main():
    root = command_line.tree(__doc__).root
    return command_line.result(list((root / "docs").rglob("*.md")), problems(root), "quotes: each block that names a file has its text")


if __name__ == "__main__":
    sys.exit(main())
