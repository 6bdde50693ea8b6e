#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs the commands of a page as they are printed, and compares their output with the page.

page_test.py INDEX PAGE PREFIX. INDEX is the page with the blocks ```sh that prepare a shell; PREFIX
is an installed mauve: /usr as from packages, or one that the home folder of the test holds as "mauve".
INDEX sets MAUVE once for either; the test leaves the other line out.

A block ```console of the page has commands ("$ " begins one, "> " continues it) and output below
them, unless "<!-- not run: REASON -->" stands above it. A command without output on the page, or with "..." alone, must succeed. In output a line "..." stands for any
lines, and "..." in a line for any text. Each time ("61 ns") stands for any other time, and each number
of missed releases for any other one: a test asserts nothing about them. The number of attempts of a change
is left out.

Any other block of commands is executed if "<!-- run -->" stands above it: as a block ```console where it has a line
that begins with "$ ", else each of its lines must succeed. "<!-- run after: COMMANDS -->" runs these before it. A command
that Ctrl-C is to end, as its line says, gets SIGINT.

A page writes files, too. The line "Write this into `FOLDER/FILE`:" above a block means that the file in the
home folder has the text of the block. "Change `FOLDER/FILE`:" stands above a block ```diff: its lines with
" " and "-" are in the file once and together, and become those with " " and "+"; "@@" separates two places.
"The file `FOLDER/FILE` contains:" compares the block with the file, like output of a command.
A page with the words "Begin with the files of [TEXT](PAGE)" begins with all that PAGE writes.
"""
import contextlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile

PREPARE = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
SET_MAUVE = re.compile(r"^export MAUVE=(\S+)\n", re.M)
BLOCK = re.compile(r"^(?:<!-- (run|not run)(?:(?: after)?: ([^\n]*))? -->\n)?(?:(Write this into|Change|The file) `([^`\n]+)`(?: contains)?:\n)?```(\w*)[^\n]*\n(.*?)^```", re.M | re.S)
EARLIER = re.compile(r"\bBegin\s+with\s+the\s+files\s+of\s+\[[^\]]*\]\(([^)]+)\)")
ATTEMPTS = re.compile(r", \d+ attempts")
VARIES = re.compile(r"(?<![\w.])\d+(\.\d+)? ?(ns|us|ms|s|sec)\b|\d+ releases? missed(?: meanwhile, on ordinary threads that the machine delays too: mauvectl doctor)?")
MARK = "\x01"
CHANGE_FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "change_file.py")


def read(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read()


def commands(block):
    """[command, output on the page] of a block ```console, in their order."""
    result = []
    for line in block.splitlines():
        if line.startswith("$ "):
            result.append([line[2:], []])
        elif line.startswith("> ") and not result[-1][1]:
            result[-1][0] += "\n" + line[2:]
        else:
            result[-1][1].append(line)
    return result


def lines_of(block):
    """[command, no output] of each command of a block that is the input of a shell."""
    result, command = [], ""
    for line in block.splitlines():
        command += line + "\n"
        if not line.strip() or re.search(r"(\\|&&|\|)\s*(#.*)?$", line) or command.count("'") % 2:
            continue
        result.append([until_ctrl_c(command.strip()), []])
        command = ""
    assert not command.strip(), f"the block ends within a command: {command}"
    return result


def until_ctrl_c(command):
    """The command, which gets SIGINT if a reader would end it so."""
    if "Ctrl-C ends it" not in command:
        return command
    return f"{{ timeout --preserve-status --signal=INT 10 {command}\n}} || test $? = 130"


def edit(order, file, text):
    """[command, output on the page]: does to a file what the page says."""
    target = "~/" + shlex.quote(file)
    if order == "The file":
        return [f"cat {target}", text.splitlines()]
    if order == "Change":
        does = f"{shlex.quote(sys.executable)} {shlex.quote(CHANGE_FILE)} {target}"
    else:
        does = f"mkdir -p $(dirname {target}) && cat >{target}"
    return [f"{does} <<'END OF THE BLOCK'\n{text}END OF THE BLOCK", []]


def steps(page):
    """[command, output on the page] in their order; an edit of a file is a command, too."""
    result = []
    for marked, before, order, file, language, text in BLOCK.findall(page):
        if marked == "not run":
            continue
        if before:
            result.append([before, []])
        if order:
            result.append(edit(order, file, text))
        elif language == "console" or marked and re.search(r"^\$ ", text, re.M):
            result += commands(text)
        elif marked:
            result += lines_of(text)
    return result


def earlier_edits(page):
    """The edits of the pages that this page, a path, continues."""
    found = EARLIER.search(read(page))
    if not found:
        return []
    before = os.path.join(os.path.dirname(page), found.group(1))
    edits = [edit(order, file, text) for _, _, order, file, _, text in BLOCK.findall(read(before))
             if order in ("Write this into", "Change")]
    return earlier_edits(before) + edits


def prepare_of(index, prefix):
    """The commands of INDEX that prepare a shell, with the MAUVE of this installation only."""
    text = "".join(PREPARE.findall(read(index)))
    used, other = ("/usr", '"$HOME/mauve"') if prefix == "/usr" else ('"$HOME/mauve"', "/usr")
    assert sorted(SET_MAUVE.findall(text)) == sorted((used, other)), f"{index} sets MAUVE once for packages, once from source"
    return SET_MAUVE.sub(lambda line: line[0] if line[1] == used else "", text)


def steps_of(page):
    """All steps of a page, a path."""
    return earlier_edits(page) + steps(read(page))


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
    """Without times, attempts and the widths of columns, which follow from them."""
    return re.sub(" +", " ", VARIES.sub("#", ATTEMPTS.sub("", text)))


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
    return {"HOME": home, "PATH": os.environ["PATH"], "LANG": "C.UTF-8", "GTEST_COLOR": "no",
            "CMAKE_BUILD_TYPE": "Page", "CXXFLAGS": "-O0", **kept}  # half the time; README is built as its reader does


def run(prepare, commands, home):
    """(exit code, output) of each command. Ends everything that the script began, also where it fails."""
    script = ["exec 2>&1", prepare]
    for command in commands:
        script += [command, f"printf '\\n{MARK}%d\\n' $?"]
    with subprocess.Popen(["bash", "-c", "\n".join(script)], cwd=home, env=environment(home), text=True,
                          errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          start_new_session=True) as bash:
        try:
            output = bash.communicate(timeout=1100)[0]
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
        if all(line.strip() == "..." for line in lines) and code != 0:
            yield f"$ {command}\nended with {code} and printed:\n{output}"
    if len(done) < len(page_steps):
        yield f"$ {page_steps[len(done)][0]}\ndid not end"


def main():
    index, page, prefix = sys.argv[1:]
    page_steps = steps_of(page)
    home = tempfile.mkdtemp(prefix="mauve_home_")
    try:
        if prefix != "/usr":
            os.symlink(prefix, os.path.join(home, "mauve"))
        done, output = run(prepare_of(index, prefix), [step[0] for step in page_steps], home)
        wrong = list(judge(page_steps, done))
        if wrong:
            print(output.replace(MARK, "exit "), *wrong, sep="\n")
        return 1 if wrong or not page_steps else 0
    finally:
        shutil.rmtree(home, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
