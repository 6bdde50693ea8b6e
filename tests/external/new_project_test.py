#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""new_project_test.py KIND PREFIX: what `mauvectl new KIND` of an installed mauve writes builds, and passes its test."""
import os
import shutil
import subprocess
import sys
import tempfile

import page_test

# Without optimisation: the compiler is most of this test.
SCRIPT = """set -e
mauvectl new "$1" my_project && cd my_project
if [ -f architecture.json ]; then
  schema=$(grep '"$schema": "file://' architecture.json | cut -d '"' -f 4)
  [ -f "${schema#file://}" ] || { echo "architecture.json names no schema that is there" >&2; exit 1; }
fi
cmake -B build -DCMAKE_PREFIX_PATH="$2" -DCMAKE_BUILD_TYPE=Debug
cmake --build build
ctest --test-dir build --output-on-failure --no-tests=error
"""


def main():
    kind, prefix = sys.argv[1:]
    home = tempfile.mkdtemp(prefix="mauve_home_")
    try:
        environment = page_test.environment(home)
        environment["PATH"] = os.path.join(prefix, "bin") + ":" + environment["PATH"]
        return subprocess.run(["bash", "-c", SCRIPT, "new", kind, prefix], cwd=home, env=environment,
                              check=False).returncode
    finally:
        shutil.rmtree(home)


if __name__ == "__main__":
    sys.exit(main())
