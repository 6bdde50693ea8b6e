#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a member is registered under another name than its own: gain{*this, "gian"}, parameter("gian", &Pid::gain).

Usage: member_names.py ROOT [-IDIR]... FILE...

Reads the sources, and each header below ROOT that they include with quotes. A comment in front of the string says
that another name is meant: gain{*this, /*as in the paper*/ "k"}.
"""
import pathlib
import re
import sys

MEMBER = re.compile(r'\b(\w+?)_?\s*\{\s*\*this\s*,\s*"([^"\n]*)"')
PARAMETER = re.compile(r'\bparameter\s*\(\s*"([^"\n]*)"\s*,\s*&\s*[\w:]*::(\w+)')
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+)"', re.MULTILINE)
# A string or character first, so that what looks like a comment inside of it is none.
COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|//[^\n]*|/\*.*?\*/', re.DOTALL)
SUFFIXES = {".h", ".hh", ".hpp", ".hxx", ".c", ".cc", ".cpp", ".cxx", ".ipp", ".inl"}


def without_comments(text):
    """The same lines, with an empty comment in place of each."""
    return COMMENT.sub(lambda found: "/**/" + "\n" * found[0].count("\n") if found[0].startswith("/") else found[0],
                       text)


def problems_of(text):
    """(line, sentence) for each member whose string differs."""
    text = without_comments(text)
    found = [(match.start(), *match.groups()) for match in MEMBER.finditer(text)]
    found += [(match.start(), *reversed(match.groups())) for match in PARAMETER.finditer(text)]
    for at, member, name in sorted(found):
        if member != name:
            yield (text.count("\n", 0, at) + 1,
                   f'member {member} is registered as "{name}"; give both one name, '
                   'or put a comment before the string if another name is meant')


def files_of(root, folders, sources):
    """Each source, and what it includes from below the root; each once."""
    waiting, seen = [pathlib.Path(source).resolve() for source in reversed(sources)], set()
    while waiting:
        file = waiting.pop()
        if file in seen or file.suffix not in SUFFIXES or not file.is_file():
            continue
        seen.add(file)
        text = file.read_text(encoding="utf-8", errors="replace")
        yield file, text
        for name in INCLUDE.findall(text):
            found = next((path for path in ((folder / name).resolve() for folder in (file.parent, *folders))
                          if path.is_file()), None)
            if found and found.is_relative_to(root):
                waiting.append(found)


def main():
    words = sys.argv[1:]
    if "-h" in words or "--help" in words:
        print(__doc__.strip())
        return 0
    folders = [pathlib.Path(word[2:]) for word in words[1:] if word.startswith("-I") and len(word) > 2]
    sources = [word for word in words[1:] if not word.startswith("-I")]
    wrong = next((word for word in words if word.startswith("-") and not word.startswith("-I")), None)
    if wrong or not sources or not pathlib.Path(words[0]).is_dir():
        print(f"member_names: unknown option '{wrong}' (see --help)" if wrong else
              "member_names: an existing ROOT and at least one FILE are needed (see --help)", file=sys.stderr)
        return 2
    root = pathlib.Path(words[0]).resolve()
    problems = [f"{file}:{line}: error: {sentence}" for file, text in files_of(root, folders, sources)
                for line, sentence in problems_of(text)]
    if problems:
        print("\n".join(problems), file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
