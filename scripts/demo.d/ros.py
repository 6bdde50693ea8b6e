# SPDX-License-Identifier: LGPL-3.0-or-later
"""ROS 1 joins the running rover: a goal comes from rostopic, its pose goes back."""
import json
import os
import pathlib
import socket
import subprocess

from running import Failed, until

MASTER, TOPIC = "/usr/bin/rosmaster", "/usr/bin/rostopic"
RESOURCES = {
    "ros_goal": {"type": "ros/subscribe_goal", "properties": {"shell.topic": "/goal"}},
    "ros_pose": {"type": "ros/publish_pose", "properties": {"shell.topic": "/pose", "shell.frame": "map"}},
}
RELAYS = {
    "goal_relay": {"type": "ros/relay_goal", "properties": {"fsm.period": "100ms"},
                   "ports": {"from": "ros_goal.read", "to": "goal.write"},
                   "task": {"priority": 15, "budget": "100us"}},
    "pose_relay": {"type": "ros/relay_pose", "properties": {"fsm.period": "100ms"},
                   "ports": {"from": "localization.pose", "to": "ros_pose.write"},
                   "task": {"priority": 15, "budget": "100us"}},
}


def require(plugins):
    for needed in (MASTER, TOPIC, str(pathlib.Path(plugins) / "ros.so")):
        if not os.path.exists(needed):
            raise Failed(f"no {needed}: scripts/setup installs ROS 1, then build again")


def prepare(place):
    """A master of our own, for the daemon and the tools. Before the daemon starts."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1", ROS_HOME=str(place))
    return port


def join(robot, port):
    """Makes ROS part of the running system, in one change; `mission` leaves, a human says where to go."""
    robot.start([MASTER, "--core", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=robot.log)
    robot.ask("load", "ros")
    system = robot.ask("export")
    system["resources"].update(RESOURCES)
    system["components"].pop("mission")
    system["components"].update(RELAYS)
    file = robot.place / "with_ros.json"
    file.write_text(json.dumps(system), encoding="utf-8")
    robot.change("apply", str(file))
    until("ROS is connected", lambda: robot.get("ros_goal.core.connected"), 30.0)


def drive_to(robot, x, y):
    message = f"{{pose: {{position: {{x: {x}, y: {y}}}, orientation: {{w: 1.0}}}}}}"
    words = ["pub", "-r", "2", "/goal", "geometry_msgs/PoseStamped", message]
    print(f"\n$ rostopic {' '.join(words[:-1])} '{message}'", flush=True)
    robot.start([TOPIC, *words], stdout=subprocess.DEVNULL, stderr=robot.log)
    robot.goal_is({"x": x, "y": y})
    until("the goal has come", lambda: robot.get("goal.read") == {"x": x, "y": y}, 30.0)


def show_pose():
    print("\n$ rostopic echo -n 1 /pose", flush=True)
    shown = subprocess.run([TOPIC, "echo", "-n", "1", "/pose"], capture_output=True, text=True,
                           timeout=60, check=False)
    print(shown.stdout, flush=True)
    if "position" not in shown.stdout:
        raise Failed("rostopic saw no pose")
