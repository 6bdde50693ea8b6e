#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lists sentences of documents and comments that break a countable rule of CONTRIBUTING.md, "Language".

Usage: sentences.py [ROOT]    prints each such sentence; fails when there is one

A sentence has at most 30 words, and its subject is a noun: no sentence begins with "what", "who" or "whoever" unless it
asks. Retired words are the matter of words.py. CHANGELOG and the decisions keep the words of their time.
"""
import re
import sys

import command_line

FOLDERS = ("ctl", "daemon", "docs", "etc", "examples", "guardian", "libruntime", "man", "plugins", "scripts", "serial",
           "systemd", "tests")
SUFFIXES = (".cpp", ".h", ".md")
PAST = ("CHANGELOG.md", "docs/decisions/")
MOST_WORDS = 30
NO_SUBJECT = re.compile(r"(What|Who|Whoever|Whatever)\b")
END = re.compile(r"(?<=[.!?:;])\s+(?=[A-Z`*\"(\[]|mauve)")
WORD = re.compile(r"[A-Za-z0-9`][\w`'’./:<>()+-]*")


def paragraphs_of_document(text):
    """Paragraphs, items of lists and cells of tables; no code, no headings, no pictures."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    paragraph = []
    for line in text.splitlines() + [""]:
        line = line.strip()
        begins = re.match(r"([-*]|\d+\.) ", line)
        if paragraph and (not line or begins or line.startswith(("|", "#", "!", "<"))):
            yield " ".join(paragraph)
            paragraph = []
        if line.startswith("|"):
            yield from (cell.strip() for cell in line.strip("|").split("|"))
        elif line and not line.startswith(("#", "!", "<")):
            paragraph.append(line[begins.end():] if begins else line)


def paragraphs_of_comments(text):
    """Comments that stand alone, their lines joined, and comments behind code."""
    paragraph = []
    for line in text.splitlines() + [""]:
        code, slashes, comment = line.partition("//")
        comment = comment.strip("/!< ")
        alone = slashes and not code.strip()
        if paragraph and (not alone or not comment):
            yield " ".join(paragraph)
            paragraph = []
        if alone and comment and not comment.startswith("SPDX"):
            paragraph.append(comment)
        elif slashes and not alone and '"' not in code and comment:
            yield comment


def sentences(name, text):
    paragraphs = paragraphs_of_document if name.endswith(".md") else paragraphs_of_comments
    for paragraph in paragraphs(text):
        paragraph = re.sub(r"\[([^]]*)\]\([^)]*\)", r"`\1`", paragraph)  # the name of a page is a noun
        yield from (sentence.strip(" *[]") for sentence in END.split(paragraph))


def problems(name, text):
    for sentence in sentences(name, text):
        words = len(WORD.findall(re.sub(r"`[^`]*`", "`x`", sentence)))
        if words > MOST_WORDS:
            yield f"{words} words, the limit is {MOST_WORDS}: {sentence}"
        elif NO_SUBJECT.match(sentence) and not sentence.rstrip(")").endswith("?"):
            yield f"its subject is no noun: {sentence}"


def files(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and path.suffix in SUFFIXES:
                yield path.relative_to(root).as_posix()
    yield from sorted(path.name for path in root.glob("*.md"))


def main():
    root = command_line.tree(__doc__).root
    names = [name for name in files(root) if not name.startswith(PAST)]
    wrong = [f"{name}: {problem}" for name in names
             for problem in problems(name, (root / name).read_text("utf-8", errors="replace"))]
    return command_line.result(names, wrong, "sentences: none breaks a rule")


if __name__ == "__main__":
    sys.exit(main())
