#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Makes docs/messages.md from the tables of messages.

Usage: messages.py [ROOT]            writes the page
       messages.py --check [ROOT]    fails when the page is not the one that the tables make

The tables are daemon/log/events.def, daemon/protocol/errors.def and daemon/protocol/refusals.def; `mauvectl explain
NAME` prints the same texts. Each refusal of the code, {Errc::KIND, "NAME"}, has a row in refusals.def with this kind,
each wrong use of mauvectl, wrong_use("NAME", ...), one of the kind usage, and each row has a use. So has each event. LEDGER counts the refusals of each file that have no name: they may only become fewer.
"""
import collections
import re
import sys

import command_line

PAGE = "docs/messages.md"
TABLES = ("daemon/log/events.def", "daemon/protocol/errors.def", "daemon/protocol/refusals.def")
CODE = ("libruntime", "daemon", "ctl", "guardian")
LEDGER = {}
WORD = re.compile(r"\w+")
HEAD = """# Messages

mauved writes *events* into its log, answers commands with *refusals*, and names *failures* of components. Each message
has a name. `mauvectl explain NAME` prints its entry on this page, also without a running mauved. The page is made from
the tables of the programs by `scripts/messages.py`.

In the text of an event, a word in braces stands for a value: `{cause}`.

These words stand in many entries; the [glossary](glossary.md) has more:

- *core*: the algorithm of a component; it can be exchanged while the component runs.
- *hook*: a function of a plugin that mauved calls to prepare or to end something, such as `on_configure()`.
- *job*: one run of a core, from its release to its next wait.
- *safe values*: the outputs that a component gives out when it stops or fails.
- *generation*: the number of a state of the running system; each change makes the next one.
- *on probation*: the time after a change in which a failure rolls the change back.
- *quarantine*: the cores that failed on probation; no change puts them in force until somebody releases them.
- *abandoned*: a thread whose code did not return. It may hang until mauved ends, and nothing waits for it.
- *poisoned*: a resource in which a call was aborted. It refuses all callers until it has a new core.
"""
STRING = r'"((?:[^"\\]|\\.)*)"'
ENTRY = re.compile(r"MAUVE_(EVENT|ERROR|FAILURE|VALUE_STATUS)\(((?:0x\w+, )?)(\w+), (?:(\w+),\s*)?"
                   rf"((?:{STRING}\s*)+),\s*((?:{STRING}\s*)+)\)")
REFUSAL = re.compile(rf"MAUVE_REFUSAL\((\w+), (\w+), (\w+),\s*((?:{STRING}\s*)+),\s*((?:{STRING}\s*)+)\)")
STATES = {"unchanged": "", "partly": "A part has changed.", "unknown": "It may still take effect.",
          "start": "mauved does not start.", "unsent": "Nothing was sent to mauved.", "apart": "mauved is not concerned."}
NAMED = re.compile(r'\{\s*Errc::(\w+),\s*"(\w+)"\s*\}')
RENAMED = re.compile(r'\.code = Errc::(\w+);\s*[\w.()]+\.id = "(\w+)"')
WRONG_USE = re.compile(r'\bwrong_use\(\s*"(\w+)"')
# A kind that is compared, printed, numbered or passed on is no refusal.
NAMELESS = re.compile(r"(?<![=!]= )(?<!case )(?<!to_string\()(?<!value_or\()(?<!-> )(?<!Errc code = )(?<!Reason\{)"
                      r"\bErrc::\w+\b(?!, -\d)")
NAMELESS_USE = re.compile(r'\bkUsage, (?!"usage")(?!std::move)|\bwrong_use\((?!\s*(?:"|std::string id|error\.id))')
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
    """Text in a table. A "<" outside of backticks would begin a tag, which a browser does not show."""
    parts = text.replace("|", "\\|").split("`")
    parts[::2] = [part.replace("<", "&lt;").replace(">", "&gt;") for part in parts[::2]]
    return "`".join(parts)


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


def refusals(text):
    """(name, kind, state, meaning, advice) of each row."""
    for found in REFUSAL.finditer(text):
        yield *found.group(1, 2, 3), joined(found[4]), joined(found[6])


def refusal_pages(text):
    marks = list(re.finditer(r"^// ## (.*)$", text, re.M)) + [None]
    for mark, after in zip(marks, marks[1:]):
        yield f"\n### {mark[1]}\n\n| name | kind | meaning | advice |\n|---|---|---|---|\n"
        for name, kind, state, meaning, advice in refusals(text[mark.end():after.start() if after else len(text)]):
            meaning = f"{meaning} {STATES[state]}".strip()
            yield f"| `{name}` | {kind} | {cell(meaning)} | {cell(advice)} |\n"


def without_comments(text):
    return re.sub(r"//.*", "", text)


def problems(root):
    """Names without a row, rows without a use, kinds that differ, and refusals without a name."""
    rows = {name: kind for name, kind, *_ in refusals((root / TABLES[2]).read_text("utf-8"))}
    others = [name for table in TABLES[:2] for _, name, *_ in entries((root / table).read_text("utf-8"))]
    counted = collections.Counter(others + [row[0] for row in refusals((root / TABLES[2]).read_text("utf-8"))])
    yield from (f"{name}: two messages have this name" for name, count in sorted(counted.items()) if count > 1)
    events = [name for kind, name, *_ in entries((root / TABLES[0]).read_text("utf-8")) if kind == "EVENT"]
    used, logged = set(), set()
    files = [file for folder in CODE for file in sorted((root / folder).rglob("*")) if file.suffix in (".h", ".cpp")]
    for file in files:
        text = without_comments(file.read_text("utf-8"))
        logged.update(WORD.findall(text))
        uses = [("usage", name) for name in WRONG_USE.findall(text)]
        for kind, name in NAMED.findall(text) + RENAMED.findall(text) + uses:
            used.add(name)
            if rows.get(name) != kind:
                yield f"{file.relative_to(root)}: \"{name}\" has no row of kind {kind} in {TABLES[2]}"
        nameless = len(NAMELESS.findall(RENAMED.sub("", NAMED.sub("", text)))) + len(NAMELESS_USE.findall(text))
        allowed = LEDGER.get(str(file.relative_to(root)), 0)
        if nameless > allowed:
            yield f"{file.relative_to(root)}: {nameless} refusals without a name, {allowed} are allowed"
        elif nameless < allowed:
            yield f"{file.relative_to(root)}: {nameless} refusals without a name: lower the {allowed} of LEDGER"
    yield from (f"{TABLES[0]}: nothing logs the event {name}; take the row out" for name in events if name not in logged)
    yield from (f"{TABLES[2]}: nothing refuses with \"{name}\"" for name in sorted(set(rows) - used))


def page(root):
    log = (root / "daemon/log/events.def").read_text("utf-8")
    errors = (root / "daemon/protocol/errors.def").read_text("utf-8")
    named = (root / TABLES[2]).read_text("utf-8")
    parts = [HEAD, "\n## Kinds of refusals\n\nA refusal has changed nothing, with the exception of `partly`. On the wire "
             "its kind is the member `name`.\n",
             *table(errors, "ERROR"),
             "\n## Refusals\n\nA refusal has a name of its own, the member `id` on the wire, and `mauvectl` prints it below "
             "the refusal. All\ncomponents run on as before, unless the entry says otherwise.\n",
             *refusal_pages(named),
             "\n## Failures\n\nAfter each of these failures the outputs of the component have their safe values. A rollback, a "
             "standby core or a\nrestart follows, as the architecture file says.\n",
             *table(errors, "FAILURE"),
             "\n## Status of a value\n\nOne of these words stands beside a value in `mauvectl get`, `watch` and `record`, or "
             "`timed_out`: the lock of the\nresource was not free in time.\n",
             *table(errors, "VALUE_STATUS"), "\n## Events\n", *events(log)]
    return "".join(parts)


def rows(root):
    """How many rows the tables have: none may be lost because it is written in another way."""
    return sum(len(re.findall(r"^MAUVE_(?:EVENT|ERROR|FAILURE|VALUE_STATUS|REFUSAL)\(", (root / name).read_text("utf-8"), re.M))
               for name in TABLES)


def main():
    arguments = command_line.tree(__doc__, "--check")
    root, checks = arguments.root, arguments.check
    missing = [name for name in TABLES if not (root / name).is_file()]
    if missing:
        print(f"messages: {', '.join(missing)} is not there; name a tree of mauve")
        return 1
    made = page(root)
    lines = len(re.findall(r"^\| `", made, re.M))
    if lines != rows(root):
        print(f"messages: the tables have {rows(root)} rows, and {lines} could be read")
        return 1
    found = list(problems(root))
    for problem in found:
        print(problem)
    if not checks:
        (root / PAGE).write_text(made, "utf-8")
    elif (root / PAGE).read_text("utf-8") != made:
        print(f"{PAGE}: differs from the tables; scripts/messages.py writes it")
        return 1
    print(f"messages: {lines} of the tables are on the page")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
