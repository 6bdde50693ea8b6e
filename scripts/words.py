#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails where a word stands that docs/glossary.md has retired.

Usage: words.py [ROOT]     prints one line for each violation: file:line: word; write the word of the glossary instead

Identifiers, comments, JSON keys and messages count alike. CHANGELOG.md and docs/decisions/ tell of the past.
"""
import pathlib
import re
import sys

GLOSSARY = "docs/glossary.md"
SUFFIXES = {".cpp", ".def", ".h", ".in", ".json", ".md", ".py", ".sh", ".txt"}
FOLDERS = ("ctl", "daemon", "docs", "etc", "guardian", "libruntime", "man", "plugins", "scripts", "tests")
PAST = ("CHANGELOG.md", "docs/decisions/", GLOSSARY)
QUOTED = re.compile(r"`([^`]+)`")


def retired_words(glossary):
    """retired word: the word in its place, from the tables whose last column is headed 'retired'."""
    retired, inside = {}, False
    for line in glossary.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            inside = False
        elif cells[-1] == "retired":
            inside = True
        elif inside:
            for word in QUOTED.findall(cells[-1]):
                retired[word] = cells[0]
    return retired


def files(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and path.suffix in SUFFIXES:
                yield path.relative_to(root).as_posix()
    yield from (path.name for path in sorted(root.glob("*.md")))


def problems(root):
    retired = retired_words((root / GLOSSARY).read_text("utf-8"))
    if not retired:
        yield f"{GLOSSARY}: no table has a column 'retired'"
        return
    pattern = re.compile(r"(?<!\w)(" + "|".join(map(re.escape, retired)) + r")(?!\w)")
    for name in files(root):
        if name.startswith(PAST):
            continue
        for number, line in enumerate((root / name).read_text("utf-8", errors="replace").splitlines(), 1):
            for word in pattern.findall(line):
                yield f"{name}:{number}: {word} is retired; write '{retired[word]}', see {GLOSSARY}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    found = list(problems(root))
    for problem in found:
        print(problem)
    if not found:
        print("words: no retired word is in use")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
