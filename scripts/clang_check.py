#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lets clang read every source, and every header alone, with all warnings as errors.

Usage: clang_check.py BUILD_FOLDER [OTHER_FOLDER | K/N]

BUILD_FOLDER is configured, with compile_commands.json. Reading finds the errors that a build finds; no code is
made, which halves the time. A source whose object is in OTHER_FOLDER, where clang has built it with the same
warnings, is not read again. K/N: only part K of N, counted from 0.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

import command_line


def check(entry):
    words = shlex.split(entry["command"])
    at = words.index("-o")
    command = words[:at] + words[at + 2:] + ["-fsyntax-only"]
    done = subprocess.run(command, cwd=entry["directory"], capture_output=True, text=True, check=False)
    return entry["file"], done.returncode, done.stdout + done.stderr


def built(entry, other):
    words = shlex.split(entry["command"])
    return (other / words[words.index("-o") + 1]).exists()


def configured(word):
    path = command_line.folder(word)
    if not (path / "compile_commands.json").is_file():
        raise argparse.ArgumentTypeError(f"'{word}' has no compile_commands.json; configure it with cmake --preset clang")
    return path


def part_or_folder(word):
    """(K, N), or the other folder."""
    part = re.fullmatch(r"(\d+)/(\d+)", word)
    if not part:
        return command_line.folder(word)
    if int(part[1]) >= int(part[2]):
        raise argparse.ArgumentTypeError(f"there is no part {word}: the first of {part[2]} is 0/{part[2]}")
    return int(part[1]), int(part[2])


def main():
    arguments = command_line.Arguments(__doc__)
    arguments.add_argument("build", type=configured)
    arguments.add_argument("less", nargs="?", type=part_or_folder)
    words = arguments.parse_args()
    entries = json.loads((words.build / "compile_commands.json").read_text("utf-8"))
    if isinstance(words.less, pathlib.Path):
        entries = [entry for entry in entries if not built(entry, words.less)]
    elif words.less:
        entries = entries[words.less[0]::words.less[1]]
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
