#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plays a recording of `mauvectl record` into an architecture: the drivers give way to players of the file.

Usage: play.py ARCHITECTURE.json RECORDING.csv [--keep NAME] [--kind TYPE=PLUGIN/KIND] [-o FILE] [-- OPTIONS of mauved]

Each recorded `RESOURCE.read` of a `shared_data` is played into that resource. The components that write it are left
out with all their connections, with the rules and transactions that name them; `--keep` leaves out the one connection
only. The result is written to ARCHITECTURE.play.json beside the architecture and run by mauved; with -o it is only
written. `--kind` names the player of a type for which plugin drivers has none.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import sys

PLAYED = ("gnss_fix imu joystick laser_scan motion_state odometry path point2d pose pose2d twist velocity").split()


def parse(text):
    """JSON with comments, as mauve reads it."""
    tokens = r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/'
    return json.loads(re.sub(tokens, lambda found: found[0] if found[0][0] == '"' else " ", text, flags=re.S))


def target_of(connection):
    return connection.get("connect") if isinstance(connection, dict) else connection


def recorded(columns, resources):
    """The shared_data of which the file has values: names with their types."""
    found = {}
    for name, resource in resources.items():
        address = f"{name}.read"
        if resource.get("type") == "shared_data" and any(c == address or c.startswith(address + ".") for c in columns):
            found[name] = resource["data"]
    return found


def names(text, gone):
    """Does a condition or a step name one of these components?"""
    return any(re.search(rf"\b{name}\b", text) for name in gone)


def leave_out(system, gone):
    """Takes the components away, and all that names them."""
    for name in gone:
        del system["components"][name]
    steps = system.get("transactions", {})
    lost = {name for name, step in steps.items() if names(json.dumps(step), gone)}
    rules = system.get("rules", [])
    kept = [rule for rule in rules if str(rule.get("do")) not in lost and not names(
        json.dumps([rule.get("when"), rule.get("until"), rule.get("do")]), gone)]
    system["transactions"] = {name: step for name, step in steps.items() if name not in lost}
    system["rules"] = kept
    for component in system["components"].values():
        requests = component.get("may_request")
        if requests:
            component["may_request"] = [name for name in requests if name not in lost]
    return [rule.get("name", "?") for rule in rules if rule not in kept]


def player(kind, path, name, priority):
    return {"type": kind, "ports": {"out": f"{name}.write"}, "task": {"priority": priority},
            "properties": {"core.recording": path, "core.address": f"{name}.read", "fsm.period": "10ms"}}


def rewrite(system, columns, path, keep=(), kinds=None):
    """The architecture with players in place of the drivers, and a line on each thing that was changed."""
    kinds = {f"{name}": f"drivers/playback_{name}" for name in PLAYED} | (kinds or {})
    resources, components, notes = system.get("resources", {}), system.get("components", {}), []
    played = recorded(columns, resources)
    if not played:
        sys.exit("play: the file has no column of a shared_data of this architecture (record RESOURCE.read)")
    gone, players = {}, {}
    for name, data in played.items():
        kind = kinds.get(data, kinds.get(data.split("/")[0]))
        if kind is None:
            sys.exit(f"play: nothing plays {data}, the type of {name}: name a player with --kind {data}=PLUGIN/KIND")
        priority = 40
        for writer, component in components.items():
            ports = component.get("ports", {})
            mine = [port for port, to in ports.items() if target_of(to) == f"{name}.write"]
            if not mine:
                continue
            priority = component.get("task", {}).get("priority", priority)
            if writer in keep:
                for port in mine:
                    del ports[port]
            else:
                gone.setdefault(writer, ports)
        players[f"play_{name}"] = player(kind, path, name, priority)
        notes.append(f"plays {name}.read as {kind}")
        plugin = kind.split("/")[0]
        if plugin not in system.setdefault("plugins", []):
            system["plugins"].append(plugin)
    silent = sorted({target_of(to) for ports in gone.values() for to in ports.values()
                     if target_of(to).split(".")[1] != "read" and target_of(to).split(".")[0] not in played})
    rules = leave_out(system, gone)
    components.update(players)
    notes += [f"leaves out {name}" for name in sorted(gone)] + [f"leaves out rule {name}" for name in rules]
    notes += [f"they wrote {address} too" for address in silent]
    return notes


def main():
    options = argparse.ArgumentParser(usage=__doc__.split("Usage: ")[1].split("\n")[0])
    options.add_argument("architecture", type=pathlib.Path)
    options.add_argument("recording", type=pathlib.Path)
    options.add_argument("--keep", action="append", default=[])
    options.add_argument("--kind", action="append", default=[])
    options.add_argument("-o", dest="output", type=pathlib.Path)
    words = sys.argv[1:]
    split = words.index("--") if "--" in words else len(words)
    asked = options.parse_args(words[:split])
    output = asked.output or asked.architecture.with_suffix(".play.json")
    try:
        system = parse(asked.architecture.read_text())
        with asked.recording.open(newline="") as file:
            columns = next(csv.reader(file), [])
    except (OSError, ValueError) as error:
        sys.exit(f"play: {error}")
    folder = output.resolve().parent
    path = os.path.relpath(asked.recording.resolve(), folder)
    if path.startswith(".."):
        path = str(asked.recording.resolve())
        print(f"play: {path} lies elsewhere, so mauved needs --allow-path {asked.recording.resolve().parent}",
              file=sys.stderr)
    for note in rewrite(system, columns, path, asked.keep, dict(kind.split("=", 1) for kind in asked.kind)):
        print(f"play: {note}", file=sys.stderr)
    try:
        output.write_text(json.dumps(system, indent=2) + "\n")
        if asked.output is None:
            os.execvp("mauved", ["mauved", str(output), *words[split + 1:]])
    except OSError as error:
        sys.exit(f"play: {error}")


if __name__ == "__main__":
    main()
