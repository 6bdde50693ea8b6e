#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lists sentences of documents and comments that break a countable rule of CONTRIBUTING.md, "Language".

Usage: sentences.py [ROOT]           fails where a file has more such sentences than scripts/sentences.txt permits
       sentences.py --list FILE...   prints each such sentence of these files
       sentences.py --keep [ROOT]    writes the counts of today into scripts/sentences.txt

A sentence has at most 30 words, and its subject is a noun: no sentence begins with "what", "who" or "whoever" unless it
asks. Retired words are the matter of words.py. Text that is older than the rules may stand for now: the ledger
scripts/sentences.txt has the number of such sentences of each file, and the number may only fall.
"""
import pathlib
import re
import sys

LEDGER = "scripts/sentences.txt"
FOLDERS = ("ctl", "daemon", "docs", "etc", "examples", "guardian", "libruntime", "man", "plugins", "scripts",
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


def counts(root):
    """file: the number of its sentences that break a rule."""
    found = {}
    for name in files(root):
        if not name.startswith(PAST):
            number = sum(1 for _ in problems(name, (root / name).read_text("utf-8", errors="replace")))
            if number:
                found[name] = number
    return found


def permitted(root):
    lines = (root / LEDGER).read_text("utf-8").splitlines()
    return {name: int(number) for number, name in (line.split() for line in lines if line and line[0] != "#")}


def keep(root):
    head = "# Sentences that are older than the rules of scripts/sentences.py: number, file. A number may only fall.\n"
    rows = [f"{number:4} {name}\n" for name, number in sorted(counts(root).items())]
    (root / LEDGER).write_text(head + "".join(rows), "utf-8")


def check(root):
    found, allowed = counts(root), permitted(root)
    wrong = 0
    for name in sorted(found.keys() | allowed.keys()):
        now, before = found.get(name, 0), allowed.get(name, 0)
        if now > before:
            wrong += 1
            print(f"{name}: {now} sentences break a rule, {before} did; scripts/sentences.py --list {name} shows them")
        elif now < before:
            wrong += 1
            print(f"{name}: {before} sentences were permitted, {now} are left; scripts/sentences.py --keep records it")
    if not wrong:
        print(f"sentences: {sum(found.values())} older ones in {len(found)} files break a rule, and no new one does")
    return 1 if wrong else 0


def main(words):
    if words[:1] == ["--list"]:
        for name in words[1:]:
            for problem in problems(name, pathlib.Path(name).read_text("utf-8")):
                print(f"{name}: {problem}")
        return 0
    keeps = words[:1] == ["--keep"]
    rest = words[1:] if keeps else words
    root = pathlib.Path(rest[0] if rest else pathlib.Path(__file__).resolve().parent.parent)
    return keep(root) if keeps else check(root)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
