#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a file, a line or a function is longer than the budget of this house.

Usage: lines.py [ROOT]     prints one line for each violation
       lines.py --stats    prints medians and the longest, for the curious
"""
import pathlib
import re
import sys

import command_line
from layers import sources

FILE_LINES = {".h": 250, ".cpp": 400}
COLUMNS = 100
FUNCTION_LINES = 60
# File: why it may break the budget. Keep it empty.
EXCEPTIONS = {}

TOKENS = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<tag>[^(\s]*)\(.*?\)(?P=tag)"|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'|^[ \t]*#(?:\\\n|[^\n])*", re.DOTALL | re.MULTILINE)
NOT_A_FUNCTION = re.compile(r"^(namespace|class|struct|enum|union|extern)\b")
ATTRIBUTES = re.compile(r"\[\[[^\]]*\]\]|template\s*<[^{;]*?>\s*(?=class|struct|union)")


def bare(text):
    """The text without comments, strings and preprocessor lines; line breaks stay."""
    return TOKENS.sub(lambda match: re.sub(r"[^\n]", " ", match.group(0)), text)


def functions(text):
    """(first line, length in lines) of each outermost block that has a parameter list in front."""
    depth, start_depth, opened, head = 0, None, 0, []
    line = 1
    for char in bare(text):
        line += char == "\n"
        if char == "{":
            depth += 1
            words = ATTRIBUTES.sub("", "".join(head)).strip()
            if start_depth is None and ")" in words and not NOT_A_FUNCTION.match(words):
                start_depth, opened = depth, line
            head = []
        elif char == "}":
            if depth == start_depth:
                yield opened, line - opened + 1
                start_depth = None
            depth -= 1
            head = []
        elif char == ";":
            head = []
        else:
            head.append(char)


def check_file(path, text):
    lines = text.splitlines()
    limit = FILE_LINES[pathlib.PurePath(path).suffix]
    if len(lines) > limit:
        yield len(lines), f"{len(lines)} lines, the limit is {limit}; move one subject into a file named after it"
    for number, line in enumerate(lines, 1):
        if len(line) > COLUMNS:
            yield number, f"{len(line)} columns, the limit is {COLUMNS}"
    for number, length in functions(text):
        if length > FUNCTION_LINES:
            yield number, f"function of {length} lines, the limit is {FUNCTION_LINES}"


def stats(files):
    lengths = sorted((length, path, line) for path, text in files.items()
                     for line, length in functions(text))
    for suffix in FILE_LINES:
        sizes = sorted((len(text.splitlines()), path) for path, text in files.items()
                       if path.endswith(suffix) and not path.startswith("tests/"))
        if sizes:
            print(f"{suffix}: {len(sizes)} files, {sum(size for size, _ in sizes)} lines, "
                  f"median {sizes[len(sizes) // 2][0]}, longest {sizes[-1][0]} {sizes[-1][1]}")
    if lengths:
        print(f"functions: {len(lengths)}, median {lengths[len(lengths) // 2][0]}, "
              f"p90 {lengths[len(lengths) * 9 // 10][0]}, longest "
              f"{lengths[-1][0]} {lengths[-1][1]}:{lengths[-1][2]}")


def main():
    arguments = command_line.tree(__doc__, "--stats")
    files = {path: (arguments.root / path).read_text(encoding="utf-8") for path in sources(arguments.root)}
    if arguments.stats and files:
        stats(files)
        return 0
    problems = [f"{path}:{line}: {problem}" for path, text in files.items() if path not in EXCEPTIONS
                for line, problem in check_file(path, text)]
    return command_line.result(files, problems, f"lines: {len(files)} files are within the budget")


if __name__ == "__main__":
    sys.exit(main())
