# SPDX-License-Identifier: LGPL-3.0-or-later
"""A copy of this machine in which a test installs packages: this one stays as it is.

Process 1 is systemd where the kernel lets it be; else it sleeps, and a stand-in for systemctl records its calls. Needs
root, namespaces and overlayfs: missing_for_a_machine() names what is not there.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
NAMESPACES = ["--pid", "--mount", "--uts", "--ipc", "--net", "--cgroup"]
STAND_IN = """#!/bin/sh
echo "$*" >>/run/systemctl.calls
case "$*" in
*preset*) exec /usr/bin/systemctl.real "$@" ;;
*is-enabled*) echo enabled ;;
esac
"""


def missing_for_a_machine():
    """What keeps a machine from being made, or None."""
    if os.geteuid() != 0:
        return "root"
    tools = [tool for tool in ("unshare", "nsenter", "setpriv", "pivot_root", "dpkg") if not shutil.which(tool)]
    if tools:
        return ", ".join(tools)
    if "overlay" not in pathlib.Path("/proc/filesystems").read_text("utf-8"):
        return "overlayfs"
    probe = subprocess.run(["unshare", "--fork", *NAMESPACES, "true"], capture_output=True, check=False)
    return None if probe.returncode == 0 else "the right to make namespaces"


def cgroup2():
    """Where control groups of version 2 are mounted, or None."""
    for line in pathlib.Path("/proc/self/mountinfo").read_text("utf-8").splitlines():
        fields = line.split()
        if fields[fields.index("-") + 1] == "cgroup2":
            return pathlib.Path(fields[4])
    return None


class Machine:
    """Runs while it is open. `files` are copied into its folder /opt/mauve-test."""

    def __init__(self, *files, stand_in=False):
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="mauve_machine_"))
        self.copy = pathlib.Path(f"{self.work}.copy")
        self.log = pathlib.Path(f"{self.work}.log")
        self.copy.mkdir()
        for file in map(pathlib.Path, files):
            (shutil.copytree if file.is_dir() else shutil.copy)(file, self.copy / file.name)
        self.group = None
        self.process = None
        self.has_systemd = False
        self.stand_in = stand_in

    def __enter__(self):
        groups = None if self.stand_in else cgroup2()
        if groups and shutil.which("/lib/systemd/systemd"):
            self.group = groups / self.work.name
            try:
                self.group.mkdir()
                self.has_systemd = self._boot(["/lib/systemd/systemd", "--system", "--unit=machine.target"])
            except OSError as error:
                print(f"no control group for a machine: {error}")
            if not self.has_systemd:
                print(f"systemd does not run in the machine:\n{self.log.read_text('utf-8', 'replace')[-2000:]}")
                self._end()
        if not self.has_systemd:
            print("systemctl is a stand-in that records its calls: no unit is started in this test")
            assert self._boot(["sleep", "infinity"]), self.log.read_text("utf-8")
            self.shell("mkdir -p /run/systemd/system && mv /usr/bin/systemctl /usr/bin/systemctl.real"
                       f" && cat >/usr/bin/systemctl <<'END' && chmod +x /usr/bin/systemctl\n{STAND_IN}END")
        return self

    def __exit__(self, *_):
        self._end()
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.rmtree(self.copy, ignore_errors=True)
        self.log.unlink(missing_ok=True)

    def _boot(self, init):
        def enter():
            os.setsid()
            if self.group:
                (self.group / "cgroup.procs").write_text(str(os.getpid()), "ascii")

        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(
                ["unshare", "--fork", "--kill-child", *NAMESPACES, HERE / "boot.sh", self.work, *init],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, preexec_fn=enter)
        for _ in range(300):
            if self.process.poll() is not None:
                return False
            if "systemd" not in init[0]:
                ready = self.run("test", "-d", "/run/changed").returncode == 0
            else:
                ready = self.run("systemctl", "is-active", "--quiet", "machine.target").returncode == 0
            if ready:
                return True
            time.sleep(0.1)
        return False

    def _first(self):
        """Process 1 of the machine, as this one numbers it; None: not yet there."""
        children = pathlib.Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        return children.read_text("ascii").split()[0] if children.exists() and children.read_text("ascii") else None

    def _end(self):
        """The kernel ends all other processes of the machine with its first one."""
        if self.process:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()
            self.process = None
        if self.group and self.group.exists():
            for _ in range(100):
                try:
                    for folder, _, _ in os.walk(self.group, topdown=False):
                        os.rmdir(folder)
                    break
                except OSError:
                    time.sleep(0.1)

    def run(self, *command, **options):
        """Runs a command in the machine; the result has its output, errors included."""
        first = self._first()
        if not first:
            return subprocess.CompletedProcess(command, 1, "the machine has not begun")
        environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "LANG": "C.UTF-8",
                       "DEBIAN_FRONTEND": "noninteractive", **options.pop("env", {})}
        return subprocess.run(["nsenter", "--target", first, "--mount", "--pid", "--uts", "--ipc", "--net", "--cgroup",
                               "--root", "--wd", *map(str, command)], text=True, errors="replace", check=False,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env=environment, **options)

    def shell(self, script, **options):
        """The output of a script of bash, which must succeed."""
        done = self.run("bash", "-euo", "pipefail", "-c", script, **options)
        if done.returncode != 0:
            raise AssertionError(f"{script}\nended with {done.returncode} and printed:\n{done.stdout}")
        return done.stdout
