#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reads what ctest --output-junit wrote: counts, and by name what failed and what was skipped and why.

Usage: results.py STAGE FILE COUNTS   appends "passed failed skipped" to COUNTS; fails when no test ran
       results.py --sum COUNTS        prints the closing line of scripts/test
"""
import pathlib
import re
import sys
import xml.etree.ElementTree


def reason(case):
    """Why a test was skipped: the first words it printed after GoogleTest's own line."""
    output = case.findtext("system-out") or ""
    found = re.search(r"Skipped\n(.+)", output) or re.search(r"(?i)^skip\w*[: ]+(.+)", output, re.M)
    if found:
        return found.group(1).strip()
    skipped = case.find("skipped")
    return skipped.get("message", "no reason given") if skipped is not None else "no reason given"


def stage_report(stage, junit, counts):
    if not pathlib.Path(junit).exists():
        print(f"{stage}: NO RESULTS: ctest wrote no report")
        return 1
    cases = xml.etree.ElementTree.parse(junit).getroot().findall("testcase")
    failed = [case.get("name") for case in cases if case.get("status") == "fail"]
    skipped = [(case.get("name"), reason(case)) for case in cases
               if case.get("status") in ("notrun", "disabled")]
    passed = len(cases) - len(failed) - len(skipped)
    with open(counts, "a", encoding="utf-8") as file:
        file.write(f"{passed} {len(failed)} {len(skipped)}\n")
    for name in failed:
        print(f"FAILED  {stage}: {name}")
    for name, why in skipped:
        print(f"SKIPPED {stage}: {name}: {why}")
    print(f"{stage}: {passed} passed, {len(failed)} failed, {len(skipped)} skipped")
    if passed + len(failed) == 0:
        print(f"{stage}: NO TEST WAS EXECUTED")
        return 1
    return 1 if failed else 0


def closing_line(counts):
    path = pathlib.Path(counts)
    rows = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    passed, failed, skipped = (sum(int(row.split()[i]) for row in rows) for i in range(3))
    print(f"{passed} passed, {failed} failed, {skipped} skipped")


if __name__ == "__main__":
    if sys.argv[1] == "--sum":
        closing_line(sys.argv[2])
        sys.exit(0)
    sys.exit(stage_report(*sys.argv[1:4]))
