#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fails when a commit breaks the rules of CONTRIBUTING.md, "Commits".

Usage: commits.py [REPOSITORY [FIRST_DATE]]    prints one line for each violation: commit: what, and what to do instead

The rules hold for commits from FIRST_DATE on; older ones cannot be changed any more. Merges are not judged.
"""
import pathlib
import subprocess
import sys

import command_line

FIRST_DATE = "2026-11-26T06:00:00+00:00"
SUBJECT_COLUMNS = 65
LINES_WITHOUT_A_BODY = 100
NOTHING_DONE = 77  # scripts/check shows it as skipped
FIELD, RECORD = "\x1f", "\x1e"


def git(repository, *words):
    return subprocess.run(["git", "-C", repository, *words], capture_output=True, text=True, check=True).stdout


def cut_off(repository):
    """The commits of a shallow clone whose parents it does not have: all files look new in them."""
    path = pathlib.Path(repository) / git(repository, "rev-parse", "--git-path", "shallow").strip()
    return set(path.read_text("utf-8").split()) if path.exists() else set()


def history(repository, first_date):
    """Yields (hash, subject, body, changed lines) of each commit since the date."""
    form = RECORD + FIELD.join(("%H", "%s", "%b")) + FIELD
    unknown = cut_off(repository)
    # --since stops at the first commit that is older, which a rebase can put in front: filter instead.
    out = git(repository, "log", "--no-merges", f"--since-as-filter={first_date}", "--numstat", f"--format={form}")
    for record in out.split(RECORD)[1:]:
        commit, subject, body, numbers = record.split(FIELD)
        if commit in unknown:
            continue
        changed = sum(int(word) for line in numbers.splitlines() for word in line.split("\t")[:2] if word.isdigit())
        yield commit, subject, body.strip(), changed


def problems_of(subject, body, changed):
    if len(subject) > SUBJECT_COLUMNS:
        yield f"its subject has {len(subject)} characters, the limit is {SUBJECT_COLUMNS}; say the rest in the body"
    if ";" in subject:
        yield "its subject joins several ideas with ';'; make one commit of each"
    if ": " not in subject:
        yield "its subject names no area; write 'area: what it does'"
    if changed > LINES_WITHOUT_A_BODY and not body:
        yield f"it changes {changed} lines and has no body; say why"


def main():
    arguments = command_line.Arguments(__doc__)
    arguments.add_argument("repository", nargs="?", type=command_line.folder, default=command_line.OF_THE_SCRIPTS)
    arguments.add_argument("first_date", nargs="?", default=FIRST_DATE)
    words = arguments.parse_args()
    try:
        commits = list(history(str(words.repository), words.first_date))
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"commits: skipped, no history can be read here ({error})")
        return NOTHING_DONE
    if not commits:
        print("commits: skipped, there is no commit to judge")
        return NOTHING_DONE
    problems = [f"{commit[:9]}: {problem} ('{subject}')" for commit, subject, body, changed in commits
                for problem in problems_of(subject, body, changed)]
    print("\n".join(problems) if problems else f"commits: {len(commits)} keep the rules")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
