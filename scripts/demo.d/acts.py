# SPDX-License-Identifier: LGPL-3.0-or-later
"""What happens to the rover on its way; each act ends when the system has answered as it should."""
import pathlib
import sys

from running import Failed, until

JOYSTICK = pathlib.Path(__file__).parent / "joystick.py"
FIELD = ["--set", "speed=0.45", "--set", "obstacle_distance=0.55", "--set", "safety_distance=0.4"]


def swap(robot, core, *more):
    return robot.change("swap-core", "control", core, *more)


def load(robot, plugin):
    print(f"\n$ mauvectl load {plugin}      # it was not there at the start", flush=True)
    print(f"  generation {robot.ask('load', plugin)['generation']}", flush=True)


def sky(robot, satellites, rule, what):
    before = robot.fired(rule)
    robot.change("set", f"world.core.satellites={satellites}")
    until(what, lambda: robot.fired(rule) > before)


def lose_satellites(robot):
    sky(robot, 3, "gnss_lost", "too few satellites: the rule gnss_lost disconnects the GNSS")


def regain_satellites(robot):
    sky(robot, 9, "gnss_back", "the sky is clear: the rule gnss_back connects it again")


def take_over(robot):
    """A human at a joystick, a FIFO here."""
    fifo = robot.place / "joystick"
    robot.change("set", f"joystick.core.device={fifo}")
    print("\n$ scripts/demo.d/joystick.py      # recorded input events", flush=True)
    human = robot.start([sys.executable, str(JOYSTICK), str(fifo)])
    until("a human takes over", lambda: robot.get("priority.core.selected") == 2)
    until("lets go, and the guidance drives on",
          lambda: robot.get("priority.core.selected") == 1 and human.poll() is not None)


def new_core(robot):
    load(robot, "guidance_extra")
    swap(robot, "guidance_extra/widest_gap")


def known_core(robot):
    swapped = swap(robot, "guidance/finite_time", "--set", "speed=0.6")["commit"]
    until("it drives with it", lambda: robot.get("control.core") == "guidance/finite_time")
    robot.draw("timeline.svg", "timeline", "--from", f"{swapped - 15_000_000}ns", "--to",
               f"{swapped + 25_000_000}ns")


def wait_for_the_building(robot):
    until("out of the yard: the rule in_the_building chooses the core for clutter",
          lambda: robot.core() == "guidance/potential_field", 60.0)


# A faulty core goes wrong after half a second of driving. On a busy machine the robot may stand for a while before.
IN_A_WHILE = 60.0  # s
LONG_PROBATION = ("--probation", "9000")  # jobs: 90 s of driving


def throwing_core(robot):
    # Else the next swap joins the probation of the last ones, and rolls back to before all of them.
    print("\n$ mauvectl confirm      # the core for clutter does well", flush=True)
    robot.run("confirm")
    load(robot, "guidance_faulty")
    swap(robot, "guidance_faulty/throwing", *LONG_PROBATION)
    until("it throws, and guidance/potential_field is back by itself",
          lambda: robot.core() == "guidance/potential_field", IN_A_WHILE)
    until("its build is in quarantine", lambda: robot.ask("quarantine")["cores"])


def slow_core(robot):
    words = ["swap-core", "control", "guidance_faulty/slow", "--budget", "12ms"]
    print(f"\n$ mauvectl {' '.join(words)}", flush=True)
    refused = robot.run(*words)
    print(f"{refused.stdout}{refused.stderr}".rstrip(), flush=True)
    if refused.returncode == 0:
        raise Failed("a core over its deadline was admitted")
    swap(robot, "guidance_faulty/slow", *LONG_PROBATION)
    until("it hid what it uses, and guidance/potential_field is back by itself",
          lambda: robot.core() == "guidance/potential_field", IN_A_WHILE)


def endless_core(robot):
    swap(robot, "guidance_faulty/endless", "--probation", "off")
    until("it never returns, and the fallback core takes over",
          lambda: robot.core() == "guidance/stop", IN_A_WHILE)
    swap(robot, "guidance/potential_field", *FIELD)


# Share of the way that is done, and what happens then.
PLAN = [
    (0.03, lose_satellites),
    (0.12, take_over),
    (0.22, regain_satellites),
    (0.28, new_core),
    (0.36, known_core),
    (0.42, wait_for_the_building),
    (0.52, throwing_core),
    (0.60, slow_core),
    (0.68, endless_core),
]
