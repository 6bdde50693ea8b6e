#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reads what ctest --output-junit wrote: counts, and by name what failed and what was skipped and why.

Usage: results.py STAGE FILE COUNTS [AGAIN]
           appends "passed failed skipped unsteady" to COUNTS; fails when a test did, or none ran.
           AGAIN is the report of a second run: a test that failed but passed there is unsteady
       results.py --run-again FILE LOG LEDGER
           prints the expression for ctest -R: the tests that failed, and those that ran beside them; fails when one of
           those that failed must not be excused. LOG is what ctest printed, LEDGER is tests/unsteady.txt
       results.py --check-ledger LEDGER TESTS
           fails when an entry of the ledger has no date or cause, or names no test below the folder TESTS
       results.py --findings PREFIX
           prints what the sanitizers found, from the files whose names begin with PREFIX; fails when they found nothing
       results.py --sum COUNTS
           prints the closing line of scripts/test
"""
import datetime
import pathlib
import re
import sys
import xml.etree.ElementTree

import command_line

MOST_UNSTEADY = 5  # of one stage; with more it is not the tests that are unsteady
FIRST_LINES, LAST_LINES = 12, 20  # lines of a test that failed, in the summary
# In ctest's words; what it calls otherwise is a crash, a hang, or was not run at all. In a real-time runtime a hang is
# the bug itself.
EXCUSABLE = ("Failed",)
BESIDE = 12  # tests that began before, and as many that began after one that failed
# Of an output that was cut nobody can say that it has no report.
REPORT = re.compile(r"ERROR: \w+Sanitizer|WARNING: ThreadSanitizer|runtime error:|LeakSanitizer"
                    r"|part of the test output was removed")

# A process that is killed while its leak checker looks at its threads leaves these lines of the checker or an empty
# file: in 8000 kills of a program at its end, 88 times the first line, 5 times the second and twice an empty file.
KILLED = re.compile(r"==[^=]+==\d+==(Unable to get registers from thread \d+\."
                    r"|Running thread \d+ was not suspended\. False leaks are possible\.)")
LAST_LINES_OF_REPORT = 60


def cases_of(junit):
    return xml.etree.ElementTree.parse(junit).getroot().findall("testcase")


def output_of(case):
    return case.findtext("system-out") or ""


def status_of(case):
    """In ctest's words. A program of GoogleTest that skipped all of its tests ends as one whose tests passed."""
    status = case.get("status")
    output = output_of(case)
    skipped = re.search(r"^\[  PASSED  \] 0 tests", output, re.M) and "\n[  SKIPPED ] " in output
    return "notrun" if status == "run" and skipped else status


def reason(case):
    """Why a test was skipped: the first words it printed after GoogleTest's own line."""
    output = output_of(case)
    found = re.search(r"Skipped\n(.+)", output) or re.search(r"(?i)^skip\w*[: ]+(.+)", output, re.M)
    if found:
        return found.group(1).strip()
    skipped = case.find("skipped")
    return skipped.get("message", "no reason given") if skipped is not None else "no reason given"


def words_of_failure(case):
    """The first failure that GoogleTest printed, and the last lines."""
    lines = output_of(case).splitlines()
    first = next((at for at, line in enumerate(lines) if line.endswith(": Failure")), None)
    begin = max(0, len(lines) - LAST_LINES)
    if first is None or first >= begin:
        return lines[begin:]
    return lines[first:min(first + FIRST_LINES, begin)] + lines[begin:]


def entries_of(ledger):
    """The tests that are known to be unsteady."""
    lines = pathlib.Path(ledger).read_text(encoding="utf-8").splitlines()
    return {line.split()[0] for line in lines if line.strip() and not line.startswith("#")}


def check_ledger(ledger, tests):
    """Each entry names a test that exists, the day on which it failed first, and its cause as far as known."""
    sources = "\n".join(path.read_text(encoding="utf-8") for path in sorted(pathlib.Path(tests).rglob("*.cpp")))
    wrong = 0
    for number, line in enumerate(pathlib.Path(ledger).read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        entry = re.fullmatch(r"(?:\w+/)?(\w+)\.(\w+)(?:/\w+)?  (\d{4}-\d{2}-\d{2})  \S.*", line)
        problem = None
        if entry is None:
            problem = "is not 'TEST  YYYY-MM-DD  cause'; two spaces part the columns"
        elif not re.search(rf"TEST(_F|_P)?\({entry[1]},\s*{entry[2]}\)", sources):
            problem = f"no test has this name below {tests}; take the entry out"
        if problem:
            print(f"{ledger}:{number}: {problem}")
            wrong += 1
    return 1 if wrong else 0


def beside(text, failed):
    """The tests that began shortly before and after those that failed, as ctest's log lists them."""
    begun = re.findall(r"^ *Start +\d+: (.+)$", text, re.M)
    near = set()
    for at, name in enumerate(begun):
        if name in failed:
            near.update(begun[max(0, at - BESIDE):at + BESIDE + 1])
    return sorted(near | set(failed))


def run_again(junit, log, ledger):
    """ctest's report does not distinguish a crash from a failure, but the list at the end of its log does."""
    text = pathlib.Path(log).read_text(encoding="utf-8", errors="replace")
    ends = re.findall(r"^\t *\d+ - (.+?) +\(([^)]+)\)", text.rpartition("The following tests FAILED:")[2],
                      re.M)
    known = entries_of(ledger)
    why_not = [f"{name}: {end}" for name, end in ends if end not in EXCUSABLE]
    why_not += [f"{name}: is not in {ledger}" for name, end in ends
                if end in EXCUSABLE and name not in known]
    if pathlib.Path(junit).exists():
        why_not += [f"{case.get('name')}: a sanitizer's report, or too much output"
                    for case in cases_of(junit)
                    if case.get("status") == "fail" and REPORT.search(output_of(case))]
    if not 0 < len(ends) <= MOST_UNSTEADY:
        why_not.append(f"{len(ends)} tests failed; from 1 to {MOST_UNSTEADY} may run again")
    for line in why_not:
        print(f"not run again: {line}", file=sys.stderr)
    if why_not:
        return 1
    print("^(" + "|".join(re.escape(name) for name in beside(text, [name for name, _ in ends])) + ")$")
    return 0


def findings(prefix):
    """A report of a killed process is printed and is no finding: the checker had found nothing until then."""
    found = False
    prefix = pathlib.Path(prefix)
    for path in sorted(prefix.parent.glob(prefix.name + ".*")):
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
        killed = all(KILLED.fullmatch(line) for line in lines)
        found = found or not killed
        end = datetime.datetime.fromtimestamp(path.stat().st_mtime).astimezone().isoformat()
        print(f"{path.name}, written until {end}" + (": killed during its leak check, no finding" if killed else ""))
        print("".join(f"    {line}\n" for line in lines[-LAST_LINES_OF_REPORT:]), end="")
    return 0 if found else 1


def stage_report(stage, junit, counts, again=None):
    if not pathlib.Path(junit).exists():
        print(f"{stage}: NO RESULTS: ctest wrote no report")
        return 1
    cases = cases_of(junit)
    repeated = cases_of(again) if again and pathlib.Path(again).exists() else []
    steady = {case.get("name") for case in repeated if status_of(case) == "run"}
    before = {case.get("name") for case in cases if case.get("status") == "fail"}
    fallen = [case for case in cases if case.get("status") == "fail"]
    fallen += [case for case in repeated  # beside one that ran again
               if case.get("status") == "fail" and case.get("name") not in before]
    unsteady = [case for case in fallen if case.get("name") in steady]
    failed = [case.get("name") for case in fallen if case.get("name") not in steady]
    skipped = [(case.get("name"), reason(case)) for case in cases
               if status_of(case) in ("notrun", "disabled")]
    passed = sum(status_of(case) == "run" for case in cases)
    with open(counts, "a", encoding="utf-8") as file:
        file.write(f"{passed} {len(failed)} {len(skipped)} {len(unsteady)}\n")
    for case in fallen:
        if case.get("name") in failed:
            print(f"FAILED  {stage}: {case.get('name')}. It had said:")
            print("".join(f"    {line}\n" for line in words_of_failure(case)), end="")
    for case in unsteady:
        print(f"UNSTEADY {stage}: {case.get('name')} failed, then passed three times beside the same tests. It had said:")
        print("\n".join(f"    {line}" for line in words_of_failure(case)))
    for name, why in skipped:
        print(f"SKIPPED {stage}: {name}: {why}")
    print(f"{stage}: {in_words(passed, len(failed), len(skipped), len(unsteady))}")
    if passed + len(fallen) == 0:
        print(f"{stage}: NO TEST WAS EXECUTED")
        return 1
    return 1 if failed else 0


def in_words(passed, failed, skipped, unsteady):
    text = f"{passed} passed, {failed} failed, {skipped} skipped"
    return f"{text}, {unsteady} unsteady" if unsteady else text


def closing_line(counts):
    path = pathlib.Path(counts)
    rows = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    print(in_words(*(sum(int(row.split()[i]) for row in rows) for i in range(4))))
    return 0 if rows else 1


COMMANDS = {"sum": (closing_line, 1), "run_again": (run_again, 3), "check_ledger": (check_ledger, 2),
            "findings": (findings, 1)}


def main():
    arguments = command_line.Arguments(__doc__)
    for name, (_, words) in COMMANDS.items():
        arguments.add_argument("--" + name.replace("_", "-"), nargs=words)
    arguments.add_argument("stage", nargs="*")
    words = vars(arguments.parse_args())
    stage = words.pop("stage")
    chosen = [(COMMANDS[name][0], given) for name, given in words.items() if given]
    if stage:
        chosen.append((stage_report, stage))
    if len(chosen) != 1 or stage and not 3 <= len(stage) <= 4:
        arguments.error("STAGE FILE COUNTS [AGAIN], or one option with its words, is needed")
    does, given = chosen[0]
    try:
        return does(*given)
    except FileNotFoundError as error:
        return command_line.wrong_use(f"there is no file '{error.filename}'")


if __name__ == "__main__":
    sys.exit(main())
