#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""tutorial_test.py PACKAGES SOURCE: the tutorials of SOURCE work as printed with the installed packages.

All happens in a copy of this machine, with MAUVE=/usr as the pages set it for packages. Without root it is skipped.
"""
import os
import pathlib
import sys

import machine

HERE = "/opt/mauve-test"


def main():
    missing = machine.missing_for_a_machine()
    if missing:
        print(f"SKIPPED: {missing} is missing, so NO tutorial was run with installed packages", file=sys.stderr)
        return 77
    packages, source = map(pathlib.Path, sys.argv[1:])
    if not list(packages.glob("mauve_*.deb")):
        sys.exit(f"no packages in {packages}: scripts/package --into {packages} (see scripts/test)")
    names = ("CXX", "CMAKE_GENERATOR", "CMAKE_BUILD_PARALLEL_LEVEL")
    kept = {name: os.environ[name] for name in names if os.environ.get(name)}
    pages = sorted((source / "docs/tutorial").glob("[0-9]*.md"))
    wrong = 0
    with machine.Machine(packages, source / "docs/tutorial", source / "tests/external", stand_in=True) as own:
        own.shell(f"dpkg --install {HERE}/{packages.name}/*.deb")
        for page in pages:
            done = own.run("python3", f"{HERE}/external/page_test.py", f"{HERE}/tutorial/README.md",
                           f"{HERE}/tutorial/{page.name}", "/usr", env=kept)
            wrong += done.returncode != 0
            print(("ok    " if done.returncode == 0 else "FAIL  ") + page.name, flush=True)
            if done.returncode != 0:
                print(done.stdout)
    return 1 if wrong or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
