#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plays a human at a joystick: writes struct input_event of <linux/input.h> to a FIFO, in time.

Usage: joystick.py FIFO [STEP...]

Makes the FIFO if there is none, and waits for a reader. A step is TIME:WHAT, the time in seconds since
the first reader came; what is one of
  hold       press the first button, the dead-man button of teleop/teleop
  release    let it go
  forward=X  the stick, -1 to 1
  left=X
  unplug     close the FIFO; the next step opens it again
Without steps: takes the robot over, drives a little, gives it back. Ends when the reader goes away.
"""
import os
import pathlib
import stat
import struct
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import command_line  # noqa: E402

EV_SYN, EV_KEY, EV_ABS = 0, 1, 3
ABS_X, ABS_Y = 0, 1
BTN_TRIGGER = 0x120
FULL = 32767
STEPS = ["0:hold", "0.2:forward=0.6", "1.5:left=0.8", "2.5:left=0", "3.5:forward=0", "4:release"]


def event(kind, code, value):
    """One struct input_event, with the wall clock's time as the kernel has it."""
    now = time.time()
    return struct.pack("@llHHi", int(now), int(now % 1 * 1e6), kind, code, value)


def events(what):
    """The bytes of one report."""
    word, _, number = what.partition("=")
    if word in ("hold", "release"):
        change = event(EV_KEY, BTN_TRIGGER, int(word == "hold"))
    elif word in ("forward", "left"):
        share = max(-1.0, min(1.0, float(number)))
        # The kernel counts backwards and to the right.
        change = event(EV_ABS, ABS_Y if word == "forward" else ABS_X, round(-share * FULL))
    else:
        raise ValueError(f"no such step: {what}")
    return change + event(EV_SYN, 0, 0)


def parsed(text):
    """(time, what); the bytes are tried so that a wrong step is reported before anything moves."""
    moment, _, what = text.partition(":")
    if what != "unplug":
        events(what)
    return float(moment), what


def play(fifo, steps):
    pipe = os.open(fifo, os.O_WRONLY)
    start = time.monotonic()
    for moment, what in steps:
        time.sleep(max(0.0, start + moment - time.monotonic()))
        if what == "unplug":
            os.close(pipe)
            pipe = None
            continue
        if pipe is None:
            pipe = os.open(fifo, os.O_WRONLY)
        os.write(pipe, events(what))
    if pipe is not None:
        os.close(pipe)


def main():
    arguments = command_line.Arguments(__doc__)
    arguments.add_argument("fifo")
    arguments.add_argument("steps", nargs="*", default=STEPS)
    words = arguments.parse_args()
    fifo = words.fifo
    try:
        steps = [parsed(text) for text in words.steps]
    except ValueError as problem:
        return command_line.wrong_use(problem)
    if not os.path.exists(fifo):
        os.mkfifo(fifo, 0o600)
    if not stat.S_ISFIFO(os.stat(fifo).st_mode):
        print(f"joystick: '{fifo}' is there and is not a FIFO; choose another path", file=sys.stderr)
        return 1
    try:
        play(fifo, steps)
    except BrokenPipeError:
        print("joystick: the reader went away", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
