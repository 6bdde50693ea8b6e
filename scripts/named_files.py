#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a document or a comment names a file that is not there, or a function in a file that does not have it.

Usage: named_files.py [ROOT]    prints one line for each violation: where: what, and what to do instead

In a document a file is named by its whole path in backquotes. A function belongs to a file when both stand together:
"`Class::function()`, `folder/file.cpp`". CHANGELOG.md and docs/decisions/ describe the past and are not read. A comment
names a file by the end of its path: "see job.h", "exec/task/job_runner.h".
"""
import re
import sys

import command_line

TOPS = "libruntime|serial|daemon|ctl|plugins|guardian|tests|scripts|etc|man|systemd|examples"
FILE = re.compile(rf"`((?:{TOPS})/[\w./-]+\.(?:h|cpp|py|json|txt|def|in|supp))`")
FUNCTION_IN_FILE = re.compile(rf"`([\w:~]+)\(\)`,\s+`((?:{TOPS})/[\w./-]+\.(?:h|cpp))`")

IN_COMMENT = re.compile(r"(?:\bsee |\bof |\bin |[(/])((?:\w+/)*\w+\.(?:h|cpp|def))\b")
# Headers of the system and of libraries that comments name.
FOREIGN = {"linux/input.h"}


def documents(root):
    # Not below build/, which the check of the site writes meanwhile.
    folders = [folder for folder in root.iterdir() if folder.is_dir() and folder.name != "build"]
    paths = [*root.glob("*.md"), *(path for folder in folders for path in folder.rglob("*.md"))]
    for path in sorted(paths):
        name = path.relative_to(root).as_posix()
        if name != "CHANGELOG.md" and not name.startswith("docs/decisions/"):
            yield name, path.read_text(encoding="utf-8")


def sources(root):
    for top in TOPS.split("|"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp", ".def") and path.is_file():
                yield path


def comment_problems(root):
    names = {path.relative_to(root).as_posix() for path in sources(root)}
    ends = {name[i + 1:] for name in names for i, letter in enumerate(name) if letter == "/"} | names
    for path in sources(root):
        name = path.relative_to(root).as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            comment = line.partition("//")[2]
            for file in IN_COMMENT.findall(" " + comment):
                if file not in ends and file not in FOREIGN:
                    yield f"{name}:{number}: {file} is not there; name the file that is"


def problems(root):
    yield from comment_problems(root)
    for name, text in documents(root):
        for file in sorted(set(FILE.findall(text))):
            if not (root / file).is_file():
                yield f"{name}: {file} is not there; name the file that is"
        for function, file in FUNCTION_IN_FILE.findall(text):
            last = function.split("::")[-1]
            if (root / file).is_file() and not re.search(rf"\b{re.escape(last)}\b", (root / file).read_text("utf-8")):
                yield f"{name}: {file} has no {function}(); name the file that has"


def main():
    root = command_line.tree(__doc__).root
    return command_line.result([*documents(root), *sources(root)], problems(root), "named files: each file and function that a document names is there")


if __name__ == "__main__":
    sys.exit(main())
