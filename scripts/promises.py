#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every test that README promises by name exists. Usage: promises.py [ROOT]"""
import pathlib
import re
import sys

SECTION = "## What you can rely on"
TEST = re.compile(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", re.MULTILINE)


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1])
    text = (root / "README.md").read_text(encoding="utf-8")
    if SECTION not in text:
        print(f"README.md: there is no section '{SECTION}'")
        return 1
    promised = re.findall(r"`(\w+\.\w+)`", text.split(SECTION)[1].split("\n## ")[0])
    there = set()
    for file in (root / "tests").rglob("*.cpp"):
        there |= {f"{suite}.{name}" for suite, name in TEST.findall(file.read_text(encoding="utf-8"))}
    missing = [name for name in promised if name not in there]
    for name in missing:
        print(f"README.md: promises {name}, and there is no such test")
    print(f"promises: {len(promised)} tests are named, {len(missing)} are missing")
    return 1 if missing or not promised else 0


if __name__ == "__main__":
    sys.exit(main())
