# SPDX-License-Identifier: LGPL-3.0-or-later
"""A mauved that runs the rover, and mauvectl to talk to it."""
import json
import math
import os
import signal
import subprocess
import threading
import time

READY_SECONDS = 20.0
STOP_SECONDS = 10.0


class Failed(Exception):
    """Something did not work; the text says what."""


def until(what, condition, seconds=10.0):
    """Waits for what the system does by itself."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            print(f"  {what}: yes", flush=True)
            return
        time.sleep(0.05)
    raise Failed(f"{what}: NO, not within {seconds:.0f} s")


class Robot:
    """Starts the daemon in its own place, records the way driven, ends everything again."""

    def __init__(self, programs, plugins, architecture, place, out):
        self.ctl = [str(programs / "mauvectl")]
        self.environment = dict(os.environ, MAUVE_SOCKET=str(place / "mauved.sock"))
        self.command = [str(programs / "mauved"), str(architecture), "--socket",
                        str(place / "mauved.sock"), "--plugin-dir", str(plugins),
                        "--admission", "strict", "--allow-path", str(place)]
        self.place = place
        self.out = out
        self.picture = out / "path.svg"
        self.log = open(out / "mauved.log", "w", encoding="utf-8")
        self.receipts = []
        self.path = []  # (x, y, name of the core that drove)
        self.driving = ""
        self.goal = (0.0, 0.0)
        self.processes = []

    def __enter__(self):
        daemon = self.start(self.command, stdout=self.log, stderr=subprocess.STDOUT)
        try:
            self.wait_until_it_answers(daemon)
            self.driving = self.core()
            self.goal_is(self.get("mission.core.goal"))
            self.start([*self.ctl, "map", "localization.predict", "--grid", "map.read", "--scan",
                        "scan.read", "--path", "path.read", "--goal", "goal.read", "--mode",
                        "control.core", "-o", str(self.picture)], stderr=self.log)
            self.follow(self.record, "--json", "watch", "localization.predict", "control.core")
            self.follow(self.show_log, "logs", "-f", "-n", "0")
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, *_):
        self.end()

    def start(self, command, **streams):
        process = subprocess.Popen(command, env=self.environment, **streams)
        self.processes.append(process)
        return process

    def follow(self, work, *words):
        process = self.start([*self.ctl, *words], stdout=subprocess.PIPE, stderr=self.log, text=True)
        threading.Thread(target=work, args=(process.stdout,), daemon=True).start()

    def end(self):
        """The last one started ends first: the picture is drawn before the daemon goes."""
        while self.processes:
            process = self.processes.pop()
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(STOP_SECONDS)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        self.log.close()

    def wait_until_it_answers(self, daemon):
        deadline = time.monotonic() + READY_SECONDS
        while time.monotonic() < deadline and daemon.poll() is None:
            if self.run("ping").returncode == 0:
                return
            time.sleep(0.05)
        self.log.flush()
        raise Failed(f"mauved did not come up, see {self.log.name}:\n"
                     + open(self.log.name, encoding="utf-8").read()[-2000:])

    def run(self, *words):
        return subprocess.run([*self.ctl, *words], env=self.environment, capture_output=True,
                              text=True, timeout=30, check=False)

    def text(self, *words):
        """What a person would see."""
        done = self.run(*words)
        return done.stdout + done.stderr

    def ask(self, *words):
        done = self.run("--json", *words)
        if done.returncode != 0:
            raise Failed(f"mauvectl {' '.join(words)}: {done.stdout}{done.stderr}".strip())
        return json.loads(done.stdout)

    def get(self, address):
        return self.ask("get", address)["value"]

    def change(self, *words):
        """Does it, and shows command and receipt."""
        print(f"\n$ mauvectl {' '.join(words)}", flush=True)
        receipt = self.ask(*words)
        self.receipts.append(receipt)
        pauses = ", ".join(f"{one['name']} paused {one['pause_ns']} ns, missed {one['missed']}"
                           for one in receipt["components"])
        print(f"  generation {receipt['generation']}, {receipt['state']}: {pauses or 'no component paused'}",
              flush=True)
        return receipt

    def draw(self, name, *words):
        """What mauvectl draws or writes, into a file beside the log."""
        done = self.run(*words, "-o", str(self.out / name))
        if done.returncode != 0:
            raise Failed(f"mauvectl {' '.join(words)}: {done.stdout}{done.stderr}".strip())

    def core(self):
        return self.get("control.core")

    def fired(self, rule):
        return next(one["fired"] for one in self.ask("rules")["items"] if one["name"] == rule)

    def goal_is(self, goal):
        self.goal = (goal["x"], goal["y"])

    def record(self, lines):
        for line in lines:
            try:
                value = json.loads(line).get("value")
            except ValueError:
                continue  # cut off at the end
            if isinstance(value, str):
                self.driving = value
            elif isinstance(value, dict):
                self.path.append((value["x"], value["y"], self.driving))

    def show_log(self, lines):
        for line in lines:
            print(f"  log | {line.rstrip()}", flush=True)

    def progress(self):
        """Share of the straight way to the goal that is done."""
        if not self.path:
            return 0.0
        left = math.dist(self.path[-1][:2], self.goal)
        return 1.0 - left / math.dist(self.path[0][:2], self.goal)
