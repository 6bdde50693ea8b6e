# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where and how `mutants` changes a source.

It works on text: clang-format leaves spaces around each operator, and none inside the brackets of
a template.
"""
import hashlib
import re

SWAPS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
         "+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "true": "false",
         "false": "true"}
OPERATORS = {"relation": r"[<>]=?|[!=]=", "logic": r"&&|\|\|", "arithmetic": r"[-+*/]|[-+]="}
LITERALS = re.compile(
    r"//[^\n]*|/\*.*?\*/|R\"(\w*)\(.*?\)\1\"|\"(?:\\.|[^\"\\\n])*\"|(?<![\w'])'(?:\\.|[^'\\\n])+'"
    r"|^[ \t]*\#(?:\\\n|[^\n])*", re.M | re.S)
NUMBER = re.compile(r"(?<![\w.'<])\d+(?=(?:ms|us|ns|s|h|[uU]?[lL]{0,2})\b(?![.'>]))")
STATEMENT = re.compile(  # a call or an assignment that has a line, or some, for itself
    r"(?<=[;{})])\s*\n[ \t]+(\*?(?:\(void\))?[A-Za-z_]\w*"
    r"(?:(?:\.|->|::)\w+|\[[^\];]*\]|\((?:[^();]|\([^();]*\))*\))*"
    r"(?:\([^;{}]*\)| [-+|&]?= [^;{}]*|\+\+);)")
NO_STATEMENT = re.compile(
    r"(return|throw|MAUVE_\w+|delete|using|goto|static_assert|assert|log\w*\b|co_\w+)\b"
    r"|.*\bEvent::|.*\blog_?[.]", re.S)


def masked(text):
    """The text with comments, literals and directives blanked, every character in its place."""
    return LITERALS.sub(lambda m: re.sub(r"[^\n]", "\0", m.group()), text)


def closing(code, begin):
    """Where the parenthesis that opens at `begin` closes."""
    depth = 0
    for i in range(begin, len(code)):
        depth += {"(": 1, ")": -1}.get(code[i], 0)
        if depth == 0:
            return i
    return len(code)


def joins_texts(code, begin, end):
    """Whether the statement around an operator has a literal text, so that + joins texts."""
    first = max(code.rfind(c, 0, begin) for c in ";{}")
    last = min((at for at in (code.find(c, end) for c in ";{}") if at >= 0), default=len(code))
    return "\0" in code[first + 1:last].strip("\0 \n")


def places_of(text):
    """(kind, begin, end, replacement) for each change of one source."""
    code = masked(text)
    for kind, operators in OPERATORS.items():
        for m in re.finditer(rf"(?<=\s)(?:{operators})(?=\s)", code):
            if kind != "arithmetic" or not joins_texts(code, *m.span()):
                yield kind, *m.span(), SWAPS[m.group()]
    for m in re.finditer(r"\bif (\()", code):
        end = closing(code, m.start(1))
        begin = max(m.start(1), code.rfind(";", m.start(1), end)) + 1
        if not re.search(r"[^=!<>]=[^=]", code[begin:end]):
            yield "condition", begin, end, f" !({text[begin:end].strip()})"
    for m in STATEMENT.finditer(code):
        if not NO_STATEMENT.match(m.group(1)):
            yield "statement", *m.span(1), ";" + "\n" * m.group(1).count("\n")
    for m in NUMBER.finditer(code):
        yield "constant", *m.span(), str(int(m.group()) + 1)
    for m in re.finditer(r"\breturn (true|false|!(?!=))", code):
        yield "result", *m.span(1), SWAPS.get(m.group(1), "")


class Mutant:
    """A source with one change."""

    def __init__(self, root, name, kind, begin, end, replacement):
        self.name, self.kind, self.file = name, kind, root / name
        self.original = self.file.read_text()
        self.text = self.original[:begin] + replacement + self.original[end:]
        first, last = self.original.count("\n", 0, begin), self.original.count("\n", 0, end) + 1
        self.line = first + 1
        self.where = f"{name}:{self.line}"
        self.before, self.after = (" ".join(" ".join(text.splitlines()[first:last]).split())
                                   for text in (self.original, self.text))


def mutants_of(root, name):
    """All mutants of one source, which is root / name."""
    return [Mutant(root, name, *place) for place in places_of((root / name).read_text())]


def rank(seed, name, text, place):
    """Depends on the changed line alone: who edits other lines gets the same mutants."""
    kind, begin, end, _ = place
    first, last = text.rfind("\n", 0, begin) + 1, text.find("\n", end)
    return hashlib.sha256(f"{seed} {name} {kind} {begin - first} {text[first:last]}".encode()).digest()


def chosen(root, names, seed):
    """The mutants of these sources in the order of the seed: each kind in turn, no line twice."""
    by_kind, lines = {}, set()
    for name in names:
        text = (root / name).read_text()
        for place in places_of(text):
            by_kind.setdefault(place[0], []).append((rank(seed, name, text, place), name, *place))
    for places in by_kind.values():
        places.sort(reverse=True)
    while any(by_kind.values()):
        for places in by_kind.values():
            while places:
                mutant = Mutant(root, *places.pop()[1:])
                if mutant.where not in lines:
                    lines.add(mutant.where)
                    yield mutant
                    break
