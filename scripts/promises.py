#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every promise of docs/promises.md has a figure and a command, and tests that exist.

Usage: promises.py [ROOT]    prints one line for each promise that has not
"""
import re
import sys

import command_line

PAGE = "docs/promises.md"
SECTION = "## Promises"
TEST = re.compile(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", re.MULTILINE)

COMMAND = re.compile(r"`[^`]+`")


def rows_without_figure(section):
    """What is wrong with rows of the table: each has a promise, a figure with its command, and tests."""
    table = [line for line in section.splitlines() if line.startswith("|")]
    for row in table[2:]:  # behind the head and its line
        cells = [cell.strip() for cell in row.strip().strip("|").split("|")]
        if len(cells) != 3:
            yield f"{len(cells)} cells instead of promise, figure and command, tests: {row[:60]}"
        elif not COMMAND.search(cells[1]) or not COMMAND.sub("", cells[1]).strip(" ·"):
            yield f"no figure with a command in backticks for: {cells[0][:60]}"


def main():
    root = command_line.tree(__doc__).root
    text = (root / PAGE).read_text(encoding="utf-8") if (root / PAGE).is_file() else ""
    if SECTION not in text:
        print(f"{PAGE}: there is no section '{SECTION}'")
        return 1
    section = text.split(SECTION)[1].split("\n## ")[0]
    promised = re.findall(r"`(\w+\.\w+)`", section)
    there = set()
    for file in (root / "tests").rglob("*.cpp"):
        there |= {f"{suite}.{name}" for suite, name in TEST.findall(file.read_text(encoding="utf-8"))}
    missing = [name for name in promised if name not in there]
    for name in missing:
        print(f"{PAGE}: promises {name}, and there is no such test")
    unfounded = list(rows_without_figure(section))
    for row in unfounded:
        print(f"{PAGE}: {row}")
    print(f"promises: {len(promised)} tests are named, {len(missing)} are missing; "
          f"{len(unfounded)} rows have no figure")
    return 1 if missing or unfounded or not promised else 0


if __name__ == "__main__":
    sys.exit(main())
