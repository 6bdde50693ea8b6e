#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when an include breaks the arrows of ARCHITECTURE.md, a plugin or example uses mauve/detail/, or a name and its
string differ.

Usage: layers.py [ROOT]    prints one line for each violation: file:line: what, and what to do instead
"""
import pathlib
import re
import sys

import command_line

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "cmake"))
import member_names  # noqa: E402

# Layer: the layers that it may use (itself always). "public" is libruntime/include/mauve.
RUNTIME = "public base rt rules model exec plugin analysis arch"
MAY_USE = {
    "public": "",
    "base": "public",
    "rt": "public base",
    "rules": "public base",
    "model": "public base rt",
    "exec": "public base rt model analysis",
    "plugin": "public base rt model",
    "analysis": "public base",
    "arch": "public base rt rules model exec plugin analysis",
    "protocol": "public base",
    "log": "public base rt",
    "daemon": RUNTIME + " protocol log",
    "guardian": "rt base",
    "ctl": "public base rt protocol log",
    "serial": "public",
    "plugins": "public serial",
    "examples": "public serial",
    "man": RUNTIME + " protocol log daemon ctl",
    "tests": RUNTIME + " protocol log daemon ctl plugins man guardian serial",
}
# A layer that uses another one in part only: the headers of that one that it may include.
PARTS = {("guardian", "rt"): "libruntime/rt/guardian/guardian_wire.h",
         ("guardian", "base"): "libruntime/base/standard_streams.h",
         ("ctl", "log"): "daemon/log/events.def",
         ("ctl", "rt"): "libruntime/rt/machine/machine_costs.h libruntime/rt/process/process.h "
                        "libruntime/rt/thread/futex.h libruntime/rt/thread/thread.h"}
# Folder: its layer. The longest match counts; a folder below libruntime that is not here is an error.
FOLDERS = {"libruntime/include": "public", "daemon/protocol": "protocol", "daemon/log": "log",
           "daemon": "daemon", "guardian": "guardian", "ctl": "ctl", "examples": "examples", "man": "man", "plugins": "plugins", "serial": "serial", "tests": "tests", "scripts": "tests",
           **{f"libruntime/{name}": name for name in RUNTIME.split()[1:]}}
# A layer in rooms: its folders from the lowest to the highest. A room includes those before it, and no other.
STAIRS = {"libruntime/rt": "process thread calls time machine ring guardian",
          "libruntime/model": "job element port resource component",
          "libruntime/plugin": "elf load stamp",
          "libruntime/arch": "text parse compare build",
          "libruntime/exec": "update task run system swap admission recovery commit prepare observe deploy"}
# Third-party or system header (a prefix of what is included): the rooms it may be in. tests/ may use all.
ROOMS = {
    "nlohmann/": "libruntime/arch/ daemon/protocol/ ctl/render/",
    "boost/asio": "daemon/server/ ctl/cli/client",
    "boost/": "",
    "fmt/": "daemon/log/",
    "CLI/": "daemon/options daemon/main ctl/cli/options ctl/cli/main",
    "Eigen/": "plugins/",
    "GeographicLib/": "plugins/",
    "yaml-cpp/": "plugins/",
    **{f"{room}/": "plugins/ros/" for room in
       ("ros", "geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs")},
    "dlfcn.h": "libruntime/plugin/ libruntime/rt/thread/ends libruntime/rt/calls/original libruntime/rt/thread/user_threads",
    "link.h": "libruntime/plugin/ libruntime/rt/thread/run_guarded libruntime/rt/thread/user_threads",
    "csetjmp": "libruntime/rt/thread/run_guarded",
    "setjmp.h": "libruntime/rt/thread/run_guarded",
    "elf.h": "libruntime/plugin/ libruntime/include/mauve/plugin.h",
    "libelf.h": "libruntime/plugin/",
    "gelf.h": "libruntime/plugin/",
    "pthread.h": "libruntime/rt/ libruntime/base/mutex serial/called_thread serial/include/mauve/serial/called_thread",
    "sched.h": "libruntime/rt/ guardian/sandbox",
    "linux/futex.h": "libruntime/rt/",
    "linux/membarrier.h": "libruntime/rt/",
    "sys/mman.h": "libruntime/rt/ libruntime/plugin/ guardian/",
    "sys/syscall.h": "libruntime/rt/ libruntime/include/mauve/job_cost.h guardian/",
    "systemd/": "daemon/",
    "iostream": "daemon/ ctl/",
    "syslog.h": "",
    "gtest/": "examples/",
    "gmock/": "",
    "benchmark/": "",
}
INCLUDE_ROOTS = ("libruntime/include", "serial/include", "libruntime", "daemon", "ctl", "man", "plugins", "tests", "guardian", "")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^">]+)[">]', re.MULTILINE)
# The answer is gone before the first row of it is looked at.
ROWS_OF_NOTHING = re.compile(r"for \([^;()]* : [^;\n]*\bask\([^;\n]*\)\[")
# Authors include mauve/ only; a name that they need and that lies deeper gets an address there.
AUTHORS = ("plugins", "examples")
DETAIL = re.compile(r"\bmauve::detail\b")
SUFFIXES = (".h", ".cpp")


def layer_of(path):
    """The layer of a path like "daemon/log/sink.cpp", or None."""
    matches = [folder for folder in FOLDERS if path.startswith(folder + "/")]
    return FOLDERS[max(matches, key=len)] if matches else None


def resolve(root, includer, name):
    """The project file that an include means, relative to root; None for a foreign header."""
    for base in (str(pathlib.PurePosixPath(includer).parent), *INCLUDE_ROOTS):
        candidate = (root / base / name).resolve()
        if candidate.is_file() and candidate.is_relative_to(root):
            return candidate.relative_to(root).as_posix()
    return None


def room_problem(path, name):
    """Why a foreign header must not be included here, or None."""
    room = next((prefix for prefix in ROOMS if name == prefix or
                 (prefix.endswith(("/", "asio")) and name.startswith(prefix))), None)
    if room is None or path.startswith(("tests/", "scripts/")):
        return None
    if any(path.startswith(allowed) for allowed in ROOMS[room].split()):
        return None
    return f"<{name}> belongs in {ROOMS[room] or 'no room but tests/'}"


def step_of(layer_folder, path):
    """The step of STAIRS on which a file of this folder stands, or None."""
    room = path[len(layer_folder) + 1:].split("/")[0]
    steps = STAIRS[layer_folder].split()
    return steps.index(room) if room in steps else None


def stairs_problem(path, target):
    """Why a room must not include a file of its own layer, or None."""
    for folder, rooms in STAIRS.items():
        if path.startswith(folder + "/") and target.startswith(folder + "/"):
            here, there = step_of(folder, path), step_of(folder, target)
            if here is None:
                return f"is in no room of {folder}; its rooms are {rooms}"
            if there is not None and there > here:
                return f"room {rooms.split()[here]} is below {rooms.split()[there]} and may not use it ({target})"
    return None


def include_problem(root, path, layer, name):
    if layer in AUTHORS and name.startswith("mauve/detail/"):
        return f"<{name}> is for the runtime; authors include mauve/*.h"
    target = resolve(root, path, name)
    if target is None:
        return room_problem(path, name)
    used = layer_of(target)
    if used == layer:
        return stairs_problem(path, target)
    if used is not None and target not in PARTS.get((layer, used), target).split():
        return f"layer {layer} may use of {used} only {PARTS[layer, used]}, not {target}"
    if used is None or used in MAY_USE[layer].split():
        return None
    return f'layer {layer} may use "{MAY_USE[layer] or "nothing"}", not {used} ({target})'


def check_file(root, path):
    text = (root / path).read_text(encoding="utf-8")
    layer = layer_of(path)
    if layer is None:
        yield 1, "is in no layer; add its folder to scripts/layers.py and ARCHITECTURE.md"
        return
    for match in INCLUDE.finditer(text):
        problem = include_problem(root, path, layer, match.group(1))
        if problem:
            yield text.count("\n", 0, match.start()) + 1, problem
    for match in DETAIL.finditer(text) if layer in AUTHORS else ():
        yield text.count("\n", 0, match.start()) + 1, "mauve::detail is for the runtime; authors use names of mauve"
    for match in ROWS_OF_NOTHING.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, "give the answer a name before the loop: it lives no longer"
    if layer != "tests":  # which give wrong and double names on purpose
        yield from member_names.problems_of(text)


def sources(root):
    for top in ("libruntime", "serial", "daemon", "guardian", "ctl", "man", "plugins", "examples", "tests", "scripts"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                yield path.relative_to(root).as_posix()


def main():
    root = command_line.tree(__doc__).root
    files = list(sources(root))
    problems = [f"{path}:{line}: {text}" for path in files
                for line, text in check_file(root, path)]
    return command_line.result(files, problems, "layers: every include follows the arrows")


if __name__ == "__main__":
    sys.exit(main())
