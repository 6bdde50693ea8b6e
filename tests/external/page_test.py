#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs the commands of a page as they are printed, and compares their output with the page.

page_test.py INDEX PAGE PREFIX. INDEX is the page with the block ```sh that prepares a shell; PREFIX
is an installed mauve, which the home folder of the test holds as "mauve".

A block ```console of the page has commands ("$ " begins one, "> " continues it) and output below
them. A command without output on the page must succeed. In output a line "..." stands for any
lines, and "..." in a line for any text. Each time ("61 ns") stands for any other time, and each number
of missed releases for any other one: a test asserts nothing about them.
"""
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

PREPARE = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
CONSOLE = re.compile(r"^```console\n(.*?)^```", re.M | re.S)
VARIES = re.compile(r"(?<![\w.])\d+(\.\d+)? ?(ns|us|ms|s|sec)\b|\d+ releases? missed")
MARK = "\x01"


def read(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read()


def steps(page):
    """(command, output on the page) in their order."""
    result = []
    for line in "".join(CONSOLE.findall(page)).splitlines():
        if line.startswith("$ "):
            result.append([line[2:], []])
        elif line.startswith("> ") and not result[-1][1]:
            result[-1][0] += "\n" + line[2:]
        else:
            result[-1][1].append(line)
    return result


def pattern_of(lines):
    """The regular expression that the output of a command matches."""
    parts = []
    for line in lines:
        if line.strip() == "...":
            parts.append(r"(.*\n)*?")
        else:
            parts.append("[^\n]*?".join(map(re.escape, even(line).rstrip().split("..."))) + r" *\n")
    return re.compile("".join(parts))


def even(text):
    """Without times and the widths of columns, which follow from them."""
    return re.sub(" +", " ", VARIES.sub("#", text))


def agrees(lines, output):
    text = even(output)
    return pattern_of(lines).fullmatch(text if text.endswith("\n") else text + "\n") is not None


def environment(home):
    """As after a login: nothing of the build, but for the compiler that also made mauve."""
    names = ("CXX", "CMAKE_GENERATOR", "CMAKE_CXX_COMPILER_LAUNCHER", "CMAKE_BUILD_PARALLEL_LEVEL")
    kept = {name: os.environ[name] for name in names if os.environ.get(name)}
    if "ccache" in kept.get("CMAKE_CXX_COMPILER_LAUNCHER", ""):
        # The home folder is another one in each run; what was compiled before is found again.
        where = subprocess.run(["ccache", "-k", "cache_dir"], capture_output=True, text=True, check=True)
        kept |= {"CCACHE_DIR": where.stdout.strip(), "CCACHE_BASEDIR": home, "CCACHE_NOHASHDIR": "1"}
    return {"HOME": home, "PATH": os.environ["PATH"], "LANG": "C.UTF-8", "GTEST_COLOR": "no", **kept}


def run(prepare, commands, home):
    """(exit code, output) of each command. Ends everything that the script began, also where it fails."""
    script = ["exec 2>&1", prepare]
    for command in commands:
        script += [command, f"printf '\\n{MARK}%d\\n' $?"]
    with subprocess.Popen(["bash", "-c", "\n".join(script)], cwd=home, env=environment(home), text=True,
                          errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          start_new_session=True) as bash:
        try:
            output = bash.communicate(timeout=540)[0]
        except subprocess.TimeoutExpired:
            os.killpg(bash.pid, signal.SIGKILL)
            output = bash.communicate()[0]
        with contextlib.suppress(ProcessLookupError):  # nothing is left of it
            os.killpg(bash.pid, signal.SIGKILL)
    done = re.findall(rf"(.*?)\n{MARK}(\d+)\n", output, re.S)
    return [(int(code), text) for text, code in done], output


def judge(page_steps, done):
    for (command, lines), (code, output) in zip(page_steps, done):
        if lines and not agrees(lines, output):
            yield f"$ {command}\nthe page prints:\n" + "\n".join(lines) + f"\nthe command printed:\n{output}"
        if not lines and code != 0:
            yield f"$ {command}\nended with {code} and printed:\n{output}"
    if len(done) < len(page_steps):
        yield f"$ {page_steps[len(done)][0]}\ndid not end"


def main():
    index, page, prefix = sys.argv[1:]
    page_steps = steps(read(page))
    home = tempfile.mkdtemp(prefix="mauve_home_")
    try:
        os.symlink(prefix, os.path.join(home, "mauve"))
        done, output = run(PREPARE.search(read(index)).group(1), [step[0] for step in page_steps], home)
        wrong = list(judge(page_steps, done))
        if wrong:
            print(output.replace(MARK, "exit "), *wrong, sep="\n")
        return 1 if wrong or not page_steps else 0
    finally:
        shutil.rmtree(home, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
