#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs what README.md prints under "Five minutes", in an empty home folder.

five_minutes_test.py README.md PREFIX. Each command runs as it is printed, but for what makes and
installs mauve (PREFIX is a copy that is installed already), the line for users of the Debian packages,
a command that Ctrl-C is to end (it gets SIGINT), and times to look on (one second is enough here).
"""
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import page_test

HEADING = re.compile(r"^## Five minutes.*?(?=^## )", re.M | re.S)
BLOCK = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)


def commands(readme):
    """The lines of all blocks under the heading, a script of bash."""
    with open(readme, encoding="utf-8") as file:
        section = HEADING.search(file.read())
    lines = "".join(BLOCK.findall(section.group(0))).splitlines()
    made = [line for line in lines if line.startswith(("cmake --preset", "cmake --install"))]
    assert len(made) == 2, f"one line makes mauve and one installs it, not {made}"
    packages = [line for line in lines if line.startswith("export MAUVE=/usr")]
    assert len(packages) == 1, f"one line is for the packages, not {packages}"
    script = []
    for line in lines:
        if line in made + packages:
            continue
        line = page_test.until_ctrl_c(line)
        line = re.sub(r"--wait \d+s", "--wait 60s", line)  # beside builds, a start takes longer than a reader's
        script.append(re.sub(r"--for \d+s", "--for 5s", line))
    return script


def environment(home):
    """As after a login: nothing of the build, but for the compiler that also made mauve."""
    kept = {key: os.environ[key] for key in ("CXX", "CMAKE_GENERATOR") if key in os.environ}
    if os.environ.get("CMAKE_CXX_COMPILER_LAUNCHER"):
        kept["CMAKE_CXX_COMPILER_LAUNCHER"] = os.environ["CMAKE_CXX_COMPILER_LAUNCHER"]
    return {"HOME": home, "PATH": os.environ["PATH"], "LANG": "C.UTF-8", **kept}


def run(script, home):
    """Ends everything that the script began, also where it fails."""
    text = "set -eu\nset -v\n" + "\n".join(script) + "\nwait\n"
    with subprocess.Popen(["bash", "-c", text], cwd=home, env=environment(home), text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, start_new_session=True) as bash:
        try:
            output = bash.communicate(timeout=1100)[0]
        finally:
            if bash.poll() != 0:
                with contextlib.suppress(ProcessLookupError):  # nothing is left of it
                    os.killpg(bash.pid, signal.SIGKILL)
        return bash.returncode, output


def read(*parts):
    with open(os.path.join(*parts), encoding="utf-8") as file:
        return file.read()


def judge(home, code, output):
    core = os.path.join(home, "my_core")
    wrong = [] if code == 0 else [f"a command ended with {code}"]
    wanted = {
        "the swap to the new core": r"^swapped control: ",
        "the reload": r"^reloaded my_core",
        "the values of pose.read": r"pose\.read .*heading",
    }
    wrong += [f"not shown: {what}" for what, text in wanted.items()
              if not re.search(text, output, re.M)]
    if code == 0:
        cache = read(core, "build", "CMakeCache.txt")
        if "\nCMAKE_BUILD_TYPE:STRING=RelWithDebInfo\n" not in cache:
            wrong.append("the core was not built with optimisation")
        if "<svg" not in read(core, "drive.svg"):
            wrong.append("drive.svg is no picture")
    return wrong


def main():
    readme, prefix = sys.argv[1:]
    home = tempfile.mkdtemp(prefix="mauve_home_")
    try:
        os.symlink(prefix, os.path.join(home, "mauve"))
        code, output = run(commands(readme), home)
        wrong = judge(home, code, output)
        if wrong:
            print(output)
            log = os.path.join(home, "my_core", "mauved.log")
            print("mauved.log:", read(log) if os.path.exists(log) else "none")
            print("\n".join(wrong))
        return 1 if wrong else 0
    finally:
        shutil.rmtree(home)


if __name__ == "__main__":
    sys.exit(main())
