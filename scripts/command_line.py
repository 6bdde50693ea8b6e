# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command line and the result of the scripts in Python.

--help prints the head of the script and does nothing else. An unknown word, a missing value or a folder that is not there
is one line on standard error, and exit code 2.
"""
import argparse
import pathlib
import re
import sys

OF_THE_SCRIPTS = pathlib.Path(__file__).resolve().parent.parent


class Arguments(argparse.ArgumentParser):
    """As argparse, with the head of the script as its help and one line for a wrong word."""

    def __init__(self, head):
        super().__init__(add_help=False, allow_abbrev=False)
        self.head = head.strip()
        self.add_argument("-h", "--help", action="store_true")

    def parse_args(self, args=None, namespace=None):
        words = sys.argv[1:] if args is None else args
        if "-h" in words or "--help" in words:
            print(self.head)
            sys.exit(0)
        for word in words:  # argparse would first name what is missing
            if word.startswith("-") and word.split("=")[0] not in self._option_string_actions:
                self.error(f"unknown option '{word}'")
        return super().parse_args(words, namespace)

    def error(self, message):
        sys.exit(wrong_use(re.sub(r"^argument (?:(?=-)|[^:]+: )", "", message)))


def wrong_use(message):
    """Prints the one line; the exit code of it."""
    print(f"{pathlib.Path(sys.argv[0]).stem}: {message} (see --help)", file=sys.stderr)
    return 2


def folder(word):
    """A path that is a folder."""
    path = pathlib.Path(word)
    if not path.is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{word}'")
    return path.resolve()


def tree(head, *switches):
    """The arguments of a check: root, the tree of this script or the one that is named, and the switches."""
    arguments = Arguments(head)
    arguments.add_argument("root", nargs="?", type=folder, default=OF_THE_SCRIPTS)
    for switch in switches:
        arguments.add_argument(switch, action="store_true")
    return arguments.parse_args()


def result(looked_at, problems, well):
    """Prints what a check found, or the line of success; its exit code. A check that looked at nothing has proved
    nothing, so it fails."""
    problems = list(problems)
    if not looked_at:
        problems.append(f"{pathlib.Path(sys.argv[0]).stem}: there was nothing to look at; name a tree of mauve")
    print("\n".join(problems) if problems else well)
    return 1 if problems else 0
