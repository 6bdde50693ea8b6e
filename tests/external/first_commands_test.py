#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""first_commands_test.py SOURCE: what README.md and CONTRIBUTING.md tell a contributor to type first works in a fresh clone.

It clones SOURCE, its last commit, and runs the marked blocks of both pages as printed, in two clones. That takes an hour or two.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

MARKED = re.compile(r"^<!-- run by tests/external/first_commands_test.py -->\n```sh\n(.*?)^```", re.M | re.S)


def run(source, page, place):
    """The exit code of the blocks of a page in a clone of their own."""
    clone, home = place / page / "clone", place / page / "home"
    home.mkdir(parents=True)
    subprocess.run(["git", "clone", "--quiet", source, clone], check=True)
    blocks = MARKED.findall((clone / page).read_text("utf-8"))
    if not blocks:
        print(f"{page} has no block for this test")
        return 1
    print(f"==> {page}", *blocks, sep="\n", flush=True)
    kept = {name: value for name, value in os.environ.items() if name in ("PATH", "LANG", "TMPDIR", "MAUVE_TEST_DATA")}
    return subprocess.run(["bash", "-exc", "".join(blocks)], cwd=clone, env={"HOME": str(home), **kept}, check=False,
                          stdin=subprocess.DEVNULL).returncode


def main():
    place = pathlib.Path(tempfile.mkdtemp(prefix="mauve_first_"))
    try:
        codes = [run(sys.argv[1], page, place) for page in ("CONTRIBUTING.md", "README.md")]
        return 1 if any(codes) else 0
    finally:
        shutil.rmtree(place, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
