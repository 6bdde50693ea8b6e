#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Makes docs/messages.md from the tables of messages.

Usage: messages.py [ROOT]            writes the page
       messages.py --check [ROOT]    fails when the page is not the one that the tables make

The tables are daemon/log/events.def and daemon/protocol/errors.def; `mauvectl explain NAME` prints the same texts.
"""
import pathlib
import re
import sys

PAGE = "docs/messages.md"
HEAD = """# Messages

mauved writes *events* into its log, answers commands with *refusals*, and names *failures* of components. Each message
has a name. `mauvectl explain NAME` prints its entry on this page, also without a running mauved. The page is made from
the tables of the programs by `scripts/messages.py`.

In the text of an event, a word in braces stands for a value: `{cause}`.
"""
STRING = r'"((?:[^"\\]|\\.)*)"'
ENTRY = re.compile(r"MAUVE_(EVENT|ERROR|FAILURE)\(((?:0x\w+, )?)(\w+), (?:(\w+),\s*)?"
                   rf"((?:{STRING}\s*)+),\s*((?:{STRING}\s*)+)\)")
GROUP = re.compile(r"^// (0\d)xx  (.*)$", re.M)


def joined(strings):
    text = "".join(re.findall(STRING, strings))
    return text.replace('\\"', '"').replace("\\\\", "\\")


def entries(text):
    """(kind, name, level, text, advice) of each row."""
    for found in ENTRY.finditer(text):
        kind, _, name, level, words = found.group(1, 2, 3, 4, 5)
        yield kind, name, level, joined(words), joined(found.group(0)[found.group(0).index(words) + len(words):])


def cell(text):
    return text.replace("|", "\\|")


def event_text(text):
    return "the message itself" if text == "{text}" else f"`{text}`"


def events(text):
    marks = list(GROUP.finditer(text)) + [None]
    for mark, after in zip(marks, marks[1:]):
        part = text[mark.end():after.start() if after else len(text)]
        yield f"\n### {mark[2][0].upper()}{mark[2][1:].split(',')[0]}\n\n| name | level | text | meaning |\n|---|---|---|---|\n"
        for _, name, level, words, advice in entries(part):
            yield f"| `{name}` | {level} | {cell(event_text(words))} | {cell(advice)} |\n"


def table(text, wanted):
    yield "\n| name | meaning | advice |\n|---|---|---|\n"
    for kind, name, _, meaning, advice in entries(text):
        if kind == wanted:
            yield f"| `{name}` | {cell(meaning)} | {cell(advice)} |\n"


def page(root):
    log = (root / "daemon/log/events.def").read_text("utf-8")
    errors = (root / "daemon/protocol/errors.def").read_text("utf-8")
    parts = [HEAD, "\n## Refusals\n\nA refusal has changed nothing, with the exception of `partly`.\n",
             *table(errors, "ERROR"),
             "\n## Failures\n\nAfter each of these failures the outputs of the component have their safe values. A rollback, a "
             "standby core or a\nrestart follows, as the architecture file says.\n",
             *table(errors, "FAILURE"), "\n## Events\n", *events(log)]
    return "".join(parts)


def rows(root):
    """How many rows the tables have: none may be lost because it is written in another way."""
    return sum(len(re.findall(r"^MAUVE_(?:EVENT|ERROR|FAILURE)\(", (root / name).read_text("utf-8"), re.M))
               for name in ("daemon/log/events.def", "daemon/protocol/errors.def"))


def main(words):
    checks = words[:1] == ["--check"]
    rest = words[1:] if checks else words
    root = pathlib.Path(rest[0] if rest else pathlib.Path(__file__).resolve().parent.parent)
    made = page(root)
    lines = len(re.findall(r"^\| `", made, re.M))
    if lines != rows(root):
        print(f"messages: the tables have {rows(root)} rows, and {lines} could be read")
        return 1
    if not checks:
        (root / PAGE).write_text(made, "utf-8")
    elif (root / PAGE).read_text("utf-8") != made:
        print(f"{PAGE}: differs from the tables; scripts/messages.py writes it")
        return 1
    print(f"messages: {lines} of the tables are on the page")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
