#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usage: debug_beside_test.py PREFIX. Every installed program, library and plugin is without debug
information, and names the file beside it that has it, of the same build."""
import pathlib
import re
import subprocess
import sys


def readelf(how, file):
    return subprocess.run(["readelf", how, str(file)], capture_output=True, text=True, check=True,
                          errors="replace").stdout


def build_id(file):
    return re.search(r"Build ID: (\w+)", readelf("-nW", file)).group(1)


def is_elf(file):
    with open(file, "rb") as opened:
        return opened.read(4) == b"\x7fELF"


def main(prefix):
    files = [file for file in pathlib.Path(prefix).rglob("*")
             if file.is_file() and not file.is_symlink() and file.parent.name != ".debug" and is_elf(file)]
    wrong = []
    for file in files:
        debug = file.parent / ".debug" / f"{file.name}.debug"
        if ".debug_info" in readelf("-SW", file):
            wrong.append(f"{file} has its debug information in itself")
        elif f"{file.name}.debug" not in readelf("--string-dump=.gnu_debuglink", file):
            wrong.append(f"{file} does not name the file of its debug information")
        elif not debug.exists() or ".debug_info" not in readelf("-SW", debug):
            wrong.append(f"{debug} has no debug information")
        elif build_id(debug) != build_id(file):
            wrong.append(f"{debug} is of another build")
    for problem in wrong:
        print(problem)
    print(f"{len(files)} files were looked at, {len(wrong)} are wrong")
    return 1 if wrong or len(files) < 5 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
