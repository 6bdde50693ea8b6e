# SPDX-License-Identifier: LGPL-3.0-or-later
"""A mauved that runs the rover, and mauvectl to talk to it."""
import json
import math
import os
import subprocess
import threading
import time

READY_SECONDS = 20.0
STOP_SECONDS = 10.0


class Failed(Exception):
    """Something did not work; the text says what."""


class Robot:
    """Starts the daemon in its own place, records the path driven, ends everything again."""

    def __init__(self, programs, plugins, architecture, place, out):
        self.ctl = [str(programs / "mauvectl")]
        self.environment = dict(os.environ, MAUVE_SOCKET=str(place / "mauved.sock"))
        self.command = [str(programs / "mauved"), str(architecture), "--socket",
                        str(place / "mauved.sock"), "--plugin-dir", str(plugins),
                        "--admission", "strict"]
        self.log = open(out / "mauved.log", "w", encoding="utf-8")
        self.receipts = []
        self.path = []  # (x, y, name of the core that drove)
        self.core = "?"
        self.daemon = self.recorder = self.tail = None

    def __enter__(self):
        self.daemon = subprocess.Popen(self.command, stdout=self.log, stderr=subprocess.STDOUT)
        try:
            self.wait_until_it_answers()
            self.core = self.core_of_control()
            world = self.ask("get", "world.core.obstacles")["value"]
            self.obstacles = [(disc["at"]["x"], disc["at"]["y"], disc["radius"]) for disc in world]
            goal = self.ask("get", "mission.core.goal")["value"]
            self.goal = (goal["x"], goal["y"])
            self.recorder = subprocess.Popen(
                [*self.ctl, "--json", "watch", "pose.read"], env=self.environment,
                stdout=subprocess.PIPE, stderr=self.log, text=True)
            self.tail = subprocess.Popen([*self.ctl, "logs", "-f", "-n", "0"], env=self.environment,
                                         stdout=subprocess.PIPE, stderr=self.log, text=True)
            for work in (self.record, self.show_log):
                threading.Thread(target=work, daemon=True).start()
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        for process in (self.recorder, self.tail, self.daemon):
            if process is None or process.poll() is not None:
                continue
            process.terminate()
            try:
                process.wait(STOP_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.log.close()

    def wait_until_it_answers(self):
        deadline = time.monotonic() + READY_SECONDS
        while time.monotonic() < deadline:
            if self.daemon.poll() is not None:
                break
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

    def change(self, *words):
        receipt = self.ask(*words)
        self.receipts.append(receipt)
        self.core = self.core_of_control()
        pauses = ", ".join(f"{one['name']} paused {one['pause_ns']} ns, missed {one['missed']}"
                           for one in receipt["components"])
        print(f"  generation {receipt['generation']}, {receipt['state']}: {pauses}", flush=True)
        return receipt

    def core_of_control(self):
        components = self.ask("status")["components"]
        return next(one["core"] for one in components if one["name"] == "control")

    def record(self):
        for line in self.recorder.stdout:
            try:
                value = json.loads(line).get("value")
            except ValueError:
                continue  # cut off at the end
            if isinstance(value, dict):
                self.path.append((value["x"], value["y"], self.core))

    def show_log(self):
        for line in self.tail.stdout:
            print(f"  log | {line.rstrip()}", flush=True)

    def progress(self):
        """Share of the straight way to the goal that is done."""
        if not self.path:
            return 0.0
        x, y, _ = self.path[-1]
        left = math.dist((x, y), self.goal)
        return 1.0 - left / math.dist(self.path[0][:2], self.goal)
