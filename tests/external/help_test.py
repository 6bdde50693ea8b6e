#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""help_test.py PREFIX: every example of `mauvectl help COMMAND` works on the rover as printed, and so do those of
`mauved --help`. The list of ctl/README.md has commands and options that are there.

A follower is ended as by Ctrl-C, and times to look on are one second here.
"""
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

import page_test

CTL = pathlib.Path(__file__).parents[2] / "ctl/README.md"
# What a reader has done before: the commands that come first, by the name of the command.
BEFORE = {
    "change": """echo '[{"set": "control.core.speed", "value": 0.4}]' >steps.json""",
    "completion": "mkdir -p ~/.local/share/bash-completion/completions",
    "rollback": "mauvectl rollback 1 --dry-run",
    "undo": "mauvectl set control.core.speed=0.25",
    "unload": "mauvectl confirm",
}
# An exit code that is an answer: nothing is so (3), or what an example names is not there on this robot (4).
ANSWERS = {"doctor": (0, 1), "quarantine": (4,), "rollback": (4,), "wait": (0, 3), "diff": (0, 1)}
# These commands change the robot, so they run in this order and after all others.
LAST = ["set", "undo", "swap-core", "load", "unload", "reload", "apply", "lock", "stop", "start"]
AFTER = {"lock": "mauvectl lock none", "swap-core": "mauvectl confirm", "reload": "mauvectl confirm"}


def text_of(mauvectl, *words):
    return subprocess.run([mauvectl, *words], capture_output=True, text=True, check=True).stdout


def names_of(help_text):
    """The names of all commands."""
    return re.findall(r"^  ([a-z][a-z-]*) ", help_text.split("\nCommands:\n")[1].split("\n\n")[0], re.M)


def example_of(mauvectl, name):
    found = re.search(r"^Example: (.*(?:\n  .*)*)$", text_of(mauvectl, "help", name), re.M)[1]
    return re.sub(r"\n +", " ", found)


def shorter(command):
    """The example, with a second to look on; a follower ends as by Ctrl-C."""
    command = re.sub(r"(--for|--wake|--timeout) \d+s\b", r"\1 1s", command)
    if "mauvectl top" in command:
        return f"(sleep 2; printf q) | TERM=xterm script -qec '{command}' /dev/null"  # it needs a terminal
    if re.search(r"mauvectl (--json )?watch|logs -f", command):
        return f"{{ timeout --preserve-status --signal=INT 3 {command} </dev/null\n}} || test $? = 130"
    return command


def steps_of(mauvectl):
    """(command, permitted exit codes) in their order."""
    names = names_of(text_of(mauvectl, "help"))
    for name in [name for name in names if name not in LAST] + LAST:
        if name in BEFORE:
            yield BEFORE[name], (0,)
        yield shorter(example_of(mauvectl, name)), ANSWERS.get(name, (0,))
        if name in AFTER:
            yield AFTER[name], (0,)


def wrong_lines(mauvectl):
    """What the list of ctl/README.md has that the program has not."""
    block = re.search(r"^<!-- compared by tests/external/help_test.py -->\n```\n(.*?)^```", CTL.read_text("utf-8"), re.M | re.S)[1]
    names = set(names_of(text_of(mauvectl, "help"))) | {"help"}
    listed = set()
    for line in block.splitlines():
        if line.startswith("mauvectl "):
            listed = set(line[len("mauvectl "):].split(" ")[0].split("|"))
            listed |= names & set(re.findall(r"(?:[,|] ?)([a-z-]+)", line))
            yield from (f"{CTL.name}: there is no command {name}" for name in listed - names)
        known = "".join(text_of(mauvectl, "help", name) for name in {"set", *(listed & names)})  # set: what each change takes
        yield from (f"{CTL.name}: {listed} has no option {option}" for option in re.findall(r"--[a-z-]+", line)
                    if option not in known and f"mauved {option}" not in line)


def main():
    mauvectl = f"{sys.argv[1]}/bin/mauvectl"
    home = tempfile.mkdtemp(prefix="mauve_home_")
    try:
        pathlib.Path(home, "mauve").symlink_to(sys.argv[1])
        shutil.copytree(f"{sys.argv[1]}/share/mauve/maps", f"{home}/maps")
        for name in ("rover.json", "architecture.schema.json"):
            shutil.copy(f"{sys.argv[1]}/share/mauve/{name}", home)
        prepare = ("export MAUVE=$HOME/mauve MAUVE_SOCKET=$HOME/mauve.sock; export PATH=$MAUVE/bin:$MAUVE/sbin:$PATH\n"
                   "mauved rover.json --state-dir state >mauved.log 2>&1 &\n"
                   "mauvectl --wait 60s ping; sleep 3")  # so long is the trace at least
        steps = [("cat mauved.log; mauvectl trace dump -o drive.mtrace", (0,)), *steps_of(mauvectl)]
        done, _ = page_test.run(prepare, [command for command, _ in steps], home)
        wrong = [f"$ {command}\nended with {code} and printed:\n{output}"
                 for (command, codes), (code, output) in zip(steps, done) if code not in codes]
        if len(done) < len(steps):
            wrong.append(f"$ {steps[len(done)][0]}\ndid not end")
        wrong += wrong_lines(mauvectl)
        print(*wrong[:20], f"{len(steps)} commands, {len(wrong)} wrong", sep="\n")
        return 1 if wrong or len(steps) < 40 else 0
    finally:
        shutil.rmtree(home, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
