#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails where a word stands that docs/glossary.md has retired.

Usage: words.py [ROOT]     prints one line for each violation: file:line: word; write the word of the glossary instead

Identifiers, comments, JSON keys, messages and names of files count alike. A word in the form `word` is found where it
stands alone, exactly as it is written. A word in the form `*some_word*` is also found within compounds: in each
identifier with several parts, whatever its style (was_some_word_by, kSomeWord, SomeWordThing), and in names of files. So a
word of ordinary English may be retired from identifiers and stay in prose. CHANGELOG.md and docs/decisions/ describe the
past.
"""
import pathlib
import re
import sys

import command_line

GLOSSARY = "docs/glossary.md"
SUFFIXES = {".cpp", ".def", ".h", ".in", ".json", ".md", ".py", ".sh", ".txt"}
FOLDERS = ("ctl", "daemon", "docs", "etc", "examples", "guardian", "libruntime", "man", "plugins", "scripts", "serial", "tests")
PAST = ("CHANGELOG.md", "docs/decisions/", GLOSSARY)
QUOTED = re.compile(r"`([^`]+)`")
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def parts_of(name):
    """The words of a compound, in lower case: one_old_word, kOldWord and old-word all hold "old", "word"."""
    return tuple(part.lower() for part in PART.findall(name))


def holds(parts, word):
    return any(parts[at:at + len(word)] == word for at in range(len(parts) - len(word) + 1))


def is_compound(identifier):
    return "_" in identifier or len(parts_of(identifier)) > 1


class Glossary:
    """The retired words, from the tables whose last column is headed 'retired'."""

    def __init__(self, text):
        self.instead, self.compounds, inside = {}, {}, False
        for line in text.splitlines():
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if not line.startswith("|"):
                inside = False
            elif cells[-1] == "retired":
                inside = True
            elif inside:
                for word in QUOTED.findall(cells[-1]):
                    self.retire(word, cells[0])
        self.alone = re.compile(r"(?<!\w)(" + "|".join(map(re.escape, self.instead)) + r")(?!\w)")

    def retire(self, word, instead):
        if word.startswith("*") and word.endswith("*"):
            word = word.strip("*")
            self.compounds[parts_of(word)] = instead
            if not is_compound(word):
                return
        self.instead[word] = instead

    def within(self, name):
        """The word in place of the one that this compound holds; None: it holds no retired word."""
        parts = parts_of(name)
        return next((instead for word, instead in self.compounds.items() if holds(parts, word)), None)

    def in_line(self, line):
        """(word, the word in its place) for each retired word of the line."""
        found = {word: self.instead[word] for word in self.alone.findall(line)}
        for name in filter(is_compound, IDENTIFIER.findall(line)):
            if name not in found and (instead := self.within(name)):
                found[name] = instead
        return found.items()

    def in_file_name(self, path):
        """(name, the word in its place) when the name of a file holds a retired word."""
        stem = pathlib.PurePath(path).stem
        alone = [instead for word, instead in self.instead.items() if parts_of(word) == parts_of(stem)]
        instead = alone[0] if alone else self.within(stem)
        return [(stem, instead)] if instead else []


def files(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and path.suffix in SUFFIXES:
                yield path.relative_to(root).as_posix()
    yield from (path.name for path in sorted(root.glob("*.md")))


def problems(root):
    if not (root / GLOSSARY).is_file():
        yield f"{GLOSSARY}: is not there"
        return
    glossary = Glossary((root / GLOSSARY).read_text("utf-8"))
    if not glossary.instead and not glossary.compounds:
        yield f"{GLOSSARY}: no table has a column 'retired'"
        return
    for name in files(root):
        if name.startswith(PAST):
            continue
        for word, instead in glossary.in_file_name(name):
            yield f"{name}: a file is named {word}, which is retired; write '{instead}', see {GLOSSARY}"
        for number, line in enumerate((root / name).read_text("utf-8", errors="replace").splitlines(), 1):
            for word, instead in glossary.in_line(line):
                yield f"{name}:{number}: {word} is retired; write '{instead}', see {GLOSSARY}"


def main():
    root = command_line.tree(__doc__).root
    return command_line.result(list(files(root)), problems(root), "words: no retired word is in use")


if __name__ == "__main__":
    sys.exit(main())
