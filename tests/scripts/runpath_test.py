#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a program or library searches for libraries in the working directory.

Usage: runpath_test.py FILE-OR-FOLDER...    exit code 77: there is no readelf
"""
import pathlib
import re
import shutil
import subprocess
import sys

TRUSTED = ("/", "$ORIGIN")


def elf_files(arguments):
    for argument in map(pathlib.Path, arguments):
        files = sorted(argument.rglob("*")) if argument.is_dir() else [argument]
        for file in files:
            if file.is_file() and not file.is_symlink() and file.open("rb").read(4) == b"\x7fELF":
                yield file


def parts_of(file):
    """All parts of its RPATH and RUNPATH."""
    dynamic = subprocess.run(["readelf", "--dynamic", "--wide", str(file)], capture_output=True, text=True, check=True)
    return [part for paths in re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", dynamic.stdout)
            for part in paths.split(":")]


def main():
    if shutil.which("readelf") is None:
        print("SKIPPED: readelf is not installed")
        return 77
    looked, wrong = 0, 0
    for file in elf_files(sys.argv[1:]):
        looked += 1
        for part in parts_of(file):
            if not part.startswith(TRUSTED):
                wrong += 1
                print(f"{file}: '{part}' in its RUNPATH depends on the working directory")
    print(f"{looked} files, {wrong} parts that depend on the working directory")
    return 0 if looked and not wrong else 1


if __name__ == "__main__":
    sys.exit(main())
