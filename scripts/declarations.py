# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reads the declarations of a C++ file of this project's style, without a compiler.

It knows as much of the language as figures and budgets need: scopes, functions, their parameters, and whether a
body follows. It does not expand macros and does not enter function bodies.
"""
import re
from dataclasses import dataclass

from lines import bare

ATTRIBUTES = re.compile(r"\[\[[^\]]*\]\]|\bMAUVE_(?:GUARDED_BY|REQUIRES|EXCLUDES|THREAD_ATTRIBUTE)\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)|\bMAUVE_NOT_ANALYSED\b|\balignas\s*\([^)]*\)|\b(?:public|private|protected)\s*:(?!:)")
CLASS = re.compile(r"\b(?:class|struct|union)\s+(?P<name>[A-Za-z_]\w*(?:::\w+)*)"
                   r"(?:\s+final)?\s*(?::(?!:).*)?$", re.DOTALL)
NAMESPACE = re.compile(r"^(?:inline\s+)?namespace\s*(?P<name>[\w:]*)$")
NAME = re.compile(r"((?:[A-Za-z_]\w*::)*(?:~?[A-Za-z_]\w*|operator\s*(?:\(\)|[^\s(]+|\w+[&*\s]*)))\s*$")
KEYWORDS = {"if", "for", "while", "switch", "return", "catch", "sizeof", "static_assert", "requires", "noexcept",
            "decltype", "alignas", "defined", "using", "typedef", "friend"}
MEMBER_INITIALISER = re.compile(r"\)\s*(?:noexcept)?\s*:(?!:).*[\w>]$|\)\s*(?:noexcept)?\s*:(?!:).*\.\.\.$", re.DOTALL)


@dataclass(frozen=True)
class Function:
    name: str          # with the classes that enclose or qualify it: "Task::begin"
    line: int
    parameters: int
    body: bool         # a body follows, else it is a declaration
    in_class: str      # the class in whose body it stands, "" outside of classes
    defaulted: bool    # = default or = delete
    hidden: bool       # static, or in a namespace without a name: another source cannot call it


def balanced(text, at, opening, closing):
    """The place behind the bracket that closes the one at `at`."""
    depth = 0
    for place in range(at, len(text)):
        depth += (text[place] == opening) - (text[place] == closing)
        if depth == 0:
            return place + 1
    return len(text)


def without_templates(text):
    """The text without each <...> that is a list of template arguments; comparisons stay."""
    before = None
    while before != text:
        before = text
        text = re.sub(r"(?<=[\w:])\s*<[^<>;{}]*>(?!\s*=)", "", text)
    return text


CONSTRAINT = re.compile(r"^\s*(?:template\s+)?(?:requires\s+[\w:]+(?:\s*(?:&&|\|\|)\s*[\w:]+)*(?=\s))?")


def without_constraints(head):
    """The head without "template <...>" and a "requires" of names in front."""
    before = None
    while before != head:
        before = head
        head = CONSTRAINT.sub("", head).strip()
    return head


def parameters_of(head, opening):
    """How many parameters the list has that begins at `opening`."""
    inner = head[opening + 1:balanced(head, opening, "(", ")") - 1].strip()
    if inner in ("", "void"):
        return 0
    depth = commas = 0
    for char in inner:
        depth += (char in "([{") - (char in ")]}")
        commas += char == "," and depth == 0
    return commas + 1


def function_of(head):
    """(name, parameters) of a head like "int Task::f(int a) const"; None when it is no function."""
    head = without_constraints(without_templates(head.strip()))
    opening = head.find("(")
    if head.startswith("operator") or " operator" in head or "::operator" in head:
        call = head.find("operator()")
        opening = head.find("(", call + len("operator()")) if call >= 0 else opening
    if opening < 0 or re.search(r"(?<![=!<>+\-*/|&^%])=(?!=)", re.sub(r"operator\s*[^\s(]+", "", head[:opening])):
        return None
    match = NAME.search(head[:opening])
    if not match or match.group(1).split("::")[-1] in KEYWORDS or head.split(None, 1)[0] in KEYWORDS:
        return None
    return re.sub(r"\s", "", match.group(1)), parameters_of(head, opening)


class Reader:
    def __init__(self, text):
        self.text = bare(text)
        self.found = []

    def line(self, at):
        return self.text.count("\n", 0, at) + 1

    def scope(self, at, names, in_class, hidden):
        """Reads up to the closing brace of a namespace or class; the place behind it."""
        begin = at
        while at < len(self.text):
            char = self.text[at]
            if char == ";":
                self.statement(self.text[begin:at], begin, names, in_class, hidden, body=False)
                begin = at = at + 1
            elif char == "}":
                return at + 1
            elif char == "(":
                at = balanced(self.text, at, "(", ")")
            elif char == "{":
                at, begin = self.block(begin, at, names, in_class, hidden)
            else:
                at += 1
        return at

    def block(self, begin, at, names, in_class, hidden):
        """What to go on at, and where the statement begins that goes on there."""
        head = ATTRIBUTES.sub(" ", self.text[begin:at]).strip()
        head = without_constraints(without_templates(head))
        space = NAMESPACE.match(head)
        if space:
            end = self.scope(at + 1, names, in_class, hidden or not space.group("name"))
            return end, end
        if head.startswith("extern") and "(" not in head:
            end = self.scope(at + 1, names, in_class, hidden)
            return end, end
        kind = CLASS.search(head)
        if kind and "(" not in head and "=" not in head and not head.startswith("enum"):
            name = kind.group("name")
            end = self.scope(at + 1, [*names, name], "::".join([*names, name]), hidden)
            return end, end
        end = balanced(self.text, at, "{", "}")
        if MEMBER_INITIALISER.search(head) or not self.statement(self.text[begin:at], begin, names, in_class, hidden,
                                                                  body=True):
            return end, begin  # an initialiser: the statement goes on behind it
        return end, end

    def statement(self, head, begin, names, in_class, hidden, body):
        plain = ATTRIBUTES.sub(" ", head)
        plain = re.sub(r"\{[^{}]*\}", "", re.sub(r"\{[^{}]*\}", "", plain))
        known = function_of(plain)
        if not known:
            return False
        name, parameters = known
        start = begin + len(head) - len(head.lstrip())
        self.found.append(Function("::".join([*names, name]), self.line(start), parameters, body, in_class,
                                   bool(re.search(r"=\s*(?:default|delete)\s*$", plain)),
                                   hidden or bool(re.match(r"\s*static\b", plain))))
        return True


def functions_of(text):
    """Each function that the text declares or defines outside of function bodies, in order."""
    reader = Reader(text)
    reader.scope(0, [], "", False)
    return reader.found
