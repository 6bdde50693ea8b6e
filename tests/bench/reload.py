#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""reload [--smoke]: how long a change of one core takes, from the saved source to its first job in a running robot.

The commands are those of README.md, "Five minutes", with the mauve of this build installed into an empty folder: the
robot in a yard drives with a core that `mauvectl new` wrote; each round edits a number in that core, builds the plugin
without a compiler cache, and reloads it.
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

BUILD = pathlib.Path(__file__).resolve().parent.parent
GOAL = 5.0  # s


class Robot:
    """A mauved with the yard, and the project my_core, in the folder `home`."""

    def __init__(self, home):
        self.core = home / "my_core"
        prefix = home / "mauve"
        kept = {name: os.environ[name] for name in ("CXX", "CMAKE_GENERATOR") if os.environ.get(name)}
        self.environment = {"HOME": str(home), "PATH": f"{prefix}/bin:{prefix}/sbin:{os.environ['PATH']}",
                            "LANG": "C.UTF-8", "MAUVE_SOCKET": str(home / "mauve.sock"),
                            "CMAKE_PREFIX_PATH": str(prefix), "CCACHE_DISABLE": "1", **kept}
        self.run(home, "cmake", "--install", BUILD, "--prefix", prefix)
        self.run(home, "mauvectl", "new", "core", "my_core")
        (self.core / "build").mkdir()
        with open(self.core / "mauved.log", "wb") as log:
            self.mauved = subprocess.Popen(
                ["mauved", prefix / "share/mauve/yard.json", "--plugin-dir", prefix / "lib/mauve/plugins",
                 "--plugin-dir", "build"], cwd=self.core, env=self.environment, stdout=log, stderr=log)

    def __enter__(self):
        self.ctl("--wait", "20s", "ping")
        self.run(self.core, "cmake", "-B", "build")
        self.build()
        self.ctl("load", "my_core")
        self.ctl("swap-core", "control", "my_core/straight")
        self.ctl("confirm")
        return self

    def __exit__(self, *_):
        self.mauved.terminate()
        self.mauved.wait()

    def run(self, place, *command):
        done = subprocess.run([*map(str, command)], cwd=place, env=self.environment, text=True, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            sys.exit(f"reload: {' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}")
        return done.stdout

    def ctl(self, *words):
        return self.run(self.core, "mauvectl", *words)

    def build(self, *options):
        self.run(self.core, "cmake", "--build", "build", *options)

    def edit(self, distance):
        header = self.core / "my_core.h"
        before = header.read_text("utf-8")
        after = before.replace("range < 0.9", "range < 1.2") if distance > 1 else before.replace("range < 1.2", "range < 0.9")
        if after == before:
            sys.exit(f"reload: {header} has no number to edit")
        header.write_text(after, "utf-8")

    def missed(self):
        """Missed releases of the component whose core is replaced."""
        return json.loads(self.ctl("--json", "stats", "control"))["components"][0]["missed"]


def seconds(action):
    begin = time.monotonic()
    action()
    return time.monotonic() - begin


def main():
    rounds = 1 if "--smoke" in sys.argv else 7
    plugins, reloads, tests = [], [], []
    with tempfile.TemporaryDirectory(prefix="mauve_reload_") as home, Robot(pathlib.Path(home)) as robot:
        for index in range(rounds):
            robot.edit(1.2 if index % 2 == 0 else 0.9)
            plugins.append(seconds(lambda: robot.build("--target", "my_core")))
            reloads.append(seconds(lambda: robot.ctl("reload", "my_core")))
            tests.append(seconds(robot.build))
            robot.ctl("confirm")
        missed = robot.missed()
    totals = [a + b for a, b in zip(plugins, reloads)]
    print(f"## A change of one core, {rounds} times; {missed} releases missed\n")
    print("| s | median | largest |\n|---|---:|---:|")
    for name, times in (("build of the plugin", plugins), ("reload", reloads), (f"both (goal {GOAL:.0f})", totals),
                        ("build of its test", tests)):
        print(f"| {name} | {statistics.median(times):.2f} | {max(times):.2f} |")


if __name__ == "__main__":
    main()
