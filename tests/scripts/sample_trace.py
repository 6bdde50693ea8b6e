# SPDX-License-Identifier: LGPL-3.0-or-later
"""A small trace for the tests of mauvectl's pictures and conversions: two tasks, one is preempted and swapped."""
import json
import pathlib
import subprocess
import sys

MS = 1_000_000
SKIPPED = 77  # ctest's word for it, see CMakeLists.txt


def component(name, priority, period):
    return {"name": name, "type": "bench::Task", "core": "bench::work", "priority": priority, "cpus": [1],
            "realtime": True, "period_ns": period * MS, "offset_ns": 0, "deadline_ns": 0, "budget_ns": 0,
            "initial": "work", "states": [{"name": "work", "kind": "execution"},
                                          {"name": "pace", "kind": "synchronization", "wait_ns": period * MS}]}


def job(name, release, start, end, period, change=0, preempted=0):
    return [[start, name, "release", "", release, change], [start, name, "begin", "work"],
            [end, name, "end", "work", preempted], [end, name, "wait", "pace", release + period * MS, preempted]]


def records():
    """A of 20 ms runs for 12 ms, from 60 ms on, with another core, for 4 ms; B of 10 ms for 2 ms, before it."""
    for release in range(0, 100 * MS, 10 * MS):
        yield from job("B", release, release + 5000, release + 2 * MS, 10)
    for release in range(0, 100 * MS, 20 * MS):
        swapped = release >= 60 * MS
        if release == 60 * MS:
            yield [release + 2 * MS, "A", "applied", "change", 60 * MS, 1]
        end = release + (6 if swapped else 16) * MS
        yield from job("A", release, release + 2 * MS, end, 20, int(swapped), int(not swapped))
    yield [35 * MS, "[control]", "prepare", "core.swap A", 0, 1]
    yield [59 * MS, "[control]", "commit", "core.swap A", 60 * MS, 1]
    yield [59 * MS, "[control]", "member", "A", 0, 1]
    yield [73 * MS, "B", "user", "gain", 0, 0.25]
    yield [95 * MS, "[probe]", "disturbed", "", 3 * MS, 0]


def write(file):
    """Writes the trace; returns how many records it has."""
    lines = sorted(records(), key=lambda record: record[0])
    header = {"mauve_trace": 1, "mauved": "0", "architecture": "bench", "boot": "", "t": "2026-01-01T00:00:00Z",
              "t0_ns": 1_000_000_000_000, "from": 0, "to": 100 * MS, "why": "command", "lost": 0,
              "components": [component("A", 20, 20), component("B", 50, 10)], "resources": []}
    end = {"end": True, "records": len(lines), "lost": 0}
    file.write_text("".join(json.dumps(line) + "\n" for line in (header, *lines, end)), encoding="utf-8")
    return len(lines)


def mauvectl(*words):
    """Runs the program named by the first argument of the test."""
    return subprocess.run([MAUVECTL, *map(str, words)], capture_output=True, text=True, check=False)


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


MAUVECTL = pathlib.Path(sys.argv.pop(1)) if len(sys.argv) > 1 else pathlib.Path("mauvectl")
