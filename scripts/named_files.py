#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a document names a file that is not there, or a function in a file that does not have it.

Usage: named_files.py [ROOT]    prints one line for each violation: document: what, and what to do instead

A file is named by its whole path in backquotes. A function belongs to a file when both stand together:
"`Class::function()`, `folder/file.cpp`". CHANGELOG.md and docs/decisions/ tell of the past and are not read.
"""
import pathlib
import re
import sys

TOPS = "libruntime|daemon|ctl|plugins|guardian|tests|scripts|etc|man|systemd"
FILE = re.compile(rf"`((?:{TOPS})/[\w./-]+\.(?:h|cpp|py|json|txt|def|in|supp))`")
FUNCTION_IN_FILE = re.compile(rf"`([\w:~]+)\(\)`,\s+`((?:{TOPS})/[\w./-]+\.(?:h|cpp))`")


def documents(root):
    for path in sorted(root.rglob("*.md")):
        name = path.relative_to(root).as_posix()
        if name != "CHANGELOG.md" and not name.startswith(("docs/decisions/", "build/")):
            yield name, path.read_text(encoding="utf-8")


def problems(root):
    for name, text in documents(root):
        for file in sorted(set(FILE.findall(text))):
            if not (root / file).is_file():
                yield f"{name}: {file} is not there; name the file that is"
        for function, file in FUNCTION_IN_FILE.findall(text):
            last = function.split("::")[-1]
            if (root / file).is_file() and not re.search(rf"\b{re.escape(last)}\b", (root / file).read_text("utf-8")):
                yield f"{name}: {file} has no {function}(); name the file that has"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    found = list(problems(root))
    print("\n".join(found) if found else "named files: each file and function that a document names is there")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
