#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Which tests may run again after a failure, and what the summary says of those that then pass."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

RESULTS = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "results.py"


def junit(cases):
    """ctest's report: name, status and output of each test."""
    return "<testsuite>" + "".join(
        f'<testcase name="{name}" status="{status}"><system-out>{output}</system-out></testcase>'
        for name, status, output in cases) + "</testsuite>"


class Results(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def results(self, *words):
        done = subprocess.run([sys.executable, RESULTS, *words], cwd=self.folder, capture_output=True,
                              text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")

    def run_again(self, ends, output="expected 1, got 2", known=("A.B", "C.D/0"), begun=()):
        self.write("first.xml", junit([(name, "fail", output) for name, _ in ends]))
        self.write("log", "".join(f"      Start {i:3}: {name}\n" for i, name in enumerate(begun))
                   + "The following tests FAILED:\n\t  1 - Inner.Test (SEGFAULT)\n"  # of an inner ctest
                   "The following tests FAILED:\n"
                   + "".join(f"\t {i:2} - {name} ({end})\n" for i, (name, end) in enumerate(ends))
                   + "Errors while running CTest\n")
        self.write("ledger", "# test  first seen  cause\n\n"
                   + "".join(f"{name}  2026-11-01  not known\n" for name in known))
        return self.results("--run-again", "first.xml", "log", "ledger")

    def refused(self, words, *arguments, **more):
        code, output = self.run_again(*arguments, **more)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def test_lets_tests_of_the_ledger_run_again(self):
        self.assertEqual(self.run_again([("A.B", "Failed"), ("C.D/0", "Failed")]), (0, "^(A\\.B|C\\.D/0)$\n"))

    def test_lets_them_run_beside_the_tests_that_ran_beside_them(self):
        begun = [f"N.{i}" for i in range(40)]
        begun[20] = "A.B"
        expression = self.run_again([("A.B", "Failed")], begun=begun)[1].strip()
        self.assertEqual([name for name in begun if re.match(expression, name)], begun[8:33])

    def test_excuses_no_test_that_is_not_in_the_ledger(self):
        self.refused("E.F: is not in ledger", [("A.B", "Failed"), ("E.F", "Failed")])

    def test_excuses_no_crash_no_hang_and_nothing_that_did_not_run(self):
        for end in ("SEGFAULT", "Subprocess aborted", "Timeout", "Not Run"):
            self.refused(f"A.B: {end}", [("A.B", end), ("C.D/0", "Failed")])

    def test_excuses_no_report_of_a_sanitizer(self):
        for report in ("==7==ERROR: AddressSanitizer: heap", "WARNING: ThreadSanitizer: data race",
                       "a.cpp:1:2: runtime error: shift", "==7==ERROR: LeakSanitizer: detected",
                       "[This part of the test output was removed since it exceeds 307200 bytes.]"):
            self.refused("A.B: a sanitizer's report", [("A.B", "Failed")], f"before\n{report}\nafter")

    def test_excuses_at_most_five_and_never_an_unknown_failure(self):
        many = [(f"A.B{i}", "Failed") for i in range(6)]
        names = [name for name, _ in many]
        self.assertEqual(self.run_again(many[:5], known=names)[0], 0)
        self.refused("6 tests failed", many, known=names)
        self.refused("0 tests failed", [])

    def test_fails_with_a_test_that_fails_beside_one_that_runs_again(self):
        self.write("first.xml", junit([("A.B", "fail", ""), ("C.D", "run", "")]))
        self.write("again.xml", junit([("A.B", "run", ""), ("C.D", "fail", "expected 7")]))
        code, output = self.results("asan", "first.xml", "counts", "again.xml")
        self.assertEqual(code, 1, output)
        self.assertIn("expected 7", output)

    def test_names_and_counts_who_is_unsteady(self):
        self.write("first.xml", junit([("A.B", "fail", "expected 1"), ("C.D", "run", "")]))
        self.write("again.xml", junit([("A.B", "run", "")]))
        code, output = self.results("asan", "first.xml", "counts", "again.xml")
        self.assertEqual(code, 0, output)
        self.assertIn("UNSTEADY asan: A.B", output)
        self.assertIn("expected 1", output)
        self.assertEqual(self.results("--sum", "counts"), (0, "1 passed, 0 failed, 0 skipped, 1 unsteady\n"))

    def test_fails_with_who_fails_again_or_is_skipped_then(self):
        self.write("first.xml", junit([("A.B", "fail", ""), ("C.D", "fail", "")]))
        self.write("again.xml", junit([("A.B", "fail", ""), ("C.D", "notrun", "")]))
        code, output = self.results("asan", "first.xml", "counts", "again.xml")
        self.assertEqual(code, 1, output)
        self.assertIn("FAILED  asan: A.B. It had said:\nFAILED  asan: C.D. It had said:\n", output)
        self.assertEqual(self.results("--sum", "counts"), (0, "0 passed, 2 failed, 0 skipped\n"))

    def skipping_program(self, last):
        """The summary of a stage with a program of two tests, of which the first is skipped."""
        self.write("first.xml", junit([("campaign", "run", f"""
[ RUN      ] A.B
a.cpp:7: Skipped
NOT TESTED: no SCHED_FIFO here

[  SKIPPED ] A.B (0 ms)
{last}
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] A.B
""")]))
        return self.results("campaign", "first.xml", "counts")

    def test_counts_a_program_that_skipped_all_of_its_tests_as_skipped(self):
        code, output = self.skipping_program("[  PASSED  ] 0 tests.")
        self.assertEqual(code, 1, output)
        self.assertIn("SKIPPED campaign: campaign: NOT TESTED: no SCHED_FIFO here\n", output)
        self.assertIn("NO TEST WAS EXECUTED", output)
        self.assertEqual(self.results("--sum", "counts"), (0, "0 passed, 0 failed, 1 skipped\n"))

    def test_counts_a_program_of_which_a_test_passed_as_passed(self):
        code, output = self.skipping_program("[       OK ] A.C (1 ms)\n[  PASSED  ] 1 test.")
        self.assertEqual(code, 0, output)
        self.assertEqual(self.results("--sum", "counts"), (0, "1 passed, 0 failed, 0 skipped\n"))

    def test_reports_the_first_failure_and_the_last_lines_of_a_test_that_failed(self):
        said = "\n".join(["a.cpp:7: Failure", "does not load", *["between"] * 40, "the end"])
        self.write("first.xml", junit([("A.B", "fail", said)]))
        output = self.results("asan", "first.xml", "counts")[1]
        self.assertIn("FAILED  asan: A.B. It had said:\n    a.cpp:7: Failure\n    does not load\n", output)
        self.assertIn("    the end\n", output)
        self.assertLess(output.count("between"), 40)

    def test_holds_the_ledger_to_tests_that_exist_with_date_and_cause(self):
        self.write("a.cpp", "TEST_F(A, B) {}\nTEST_P(C, D) {}\n")
        good = "# comment\nA.B  2026-11-01  not known\nPieces/C.D/Slow  2026-11-01  not known\n"
        self.write("ledger", good)
        self.assertEqual(self.results("--check-ledger", "ledger", "."), (0, ""))
        for bad in ("A.B  2026-11-01", "A.B yesterday not known", "A.X  2026-11-01  not known"):
            self.write("ledger", good + bad + "\n")
            code, output = self.results("--check-ledger", "ledger", ".")
            self.assertEqual(code, 1)
            self.assertIn("ledger:4:", output)

    def test_finds_every_report_of_a_sanitizer(self):
        for number, words in enumerate((
                "==mauved==7==ERROR: LeakSanitizer: detected memory leaks",
                "WARNING: ThreadSanitizer: data race (pid=7)",
                "a.cpp:7:3: runtime error: signed integer overflow",
                "AddressSanitizer: CHECK failed: asan_allocator.cpp:7",
                "==mauved==8==Unable to get registers from thread 7.\n==mauved==7==ERROR: LeakSanitizer: leaks")):
            self.write(f"report.mauved.{number}", words + "\n")
            code, output = self.results("--findings", "report")
            self.assertEqual(code, 0, output)
            self.assertIn(words.splitlines()[-1], output)
            (self.folder / f"report.mauved.{number}").unlink()
        self.assertEqual(self.results("--findings", "report"), (1, ""))

    def test_shows_the_report_of_a_process_killed_during_its_leak_check_which_is_no_finding(self):
        self.write("report.mauved.7", "==mauved==8==Unable to get registers from thread 7.\n")
        self.write("report.mauved.9", "==mauved==10==Running thread 9 was not suspended. False leaks are possible.\n")
        self.write("report.mauved.11", "")
        code, output = self.results("--findings", "report")
        self.assertEqual(code, 1, output)
        self.assertEqual(output.count("killed during its leak check, no finding"), 3, output)

    def test_fails_when_nobody_ran_again(self):
        self.write("first.xml", junit([("A.B", "fail", "")]))
        self.assertEqual(self.results("asan", "first.xml", "counts", "again.xml")[0], 1)


if __name__ == "__main__":
    unittest.main()
