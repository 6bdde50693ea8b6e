#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""change_file.py FILE <BLOCK: changes FILE as a block ```diff of a page shows it.

The lines of BLOCK that begin with " " or "-" are in FILE once and together; those with " " and "+" replace
them. A line "@@" separates two places. An empty line is one that stays.
"""
import re
import sys


def lines_of(place, marks):
    return "".join(line[1:] + "\n" for line in place.splitlines() if (line or " ")[0] in marks)


def changed(text, block):
    """The new text; a ValueError names a place that is not in the text once."""
    text = "\n" + text
    for place in re.split(r"^@@.*\n", block, flags=re.M):
        before, after = "\n" + lines_of(place, " -"), "\n" + lines_of(place, " +")
        if text.count(before) != 1:
            raise ValueError(f"these lines are in the file {text.count(before)} times:{before}")
        text = text.replace(before, after)
    return text[1:]


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    try:
        text = changed(text, sys.stdin.read())
    except ValueError as error:
        sys.exit(f"{sys.argv[1]}: {error}")
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
