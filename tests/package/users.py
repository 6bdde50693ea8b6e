# SPDX-License-Identifier: LGPL-3.0-or-later
"""Four users of a machine: what each may ask a mauved that runs as a service.

The kernel tells mauved the user and the groups of each client, so these are users with an entry in /etc/passwd, and
their processes have the groups of a login.
"""
import dataclasses
import json

SOCKET = "/run/mauve/mauved.sock"
NOT_PERMITTED = 5  # exit code of mauvectl
# Each leaves the system as it was.
LOOK = ("status", "list clients", "logs", "export")
CHANGE = ("set counter.core.step=2 --probation off", "set counter.core.step=1 --probation off", "stop counter",
          "start counter", "stop --all", "start --all")
RUN_CODE = ("load types", "unload types")


@dataclasses.dataclass
class User:
    name: str
    group: str  # none of the three of mauve for a user without a role
    role: str
    may: tuple
    may_not: tuple


USERS = (
    User("ann", "mauve-view", "viewer", LOOK, CHANGE + RUN_CODE),
    User("bob", "mauve", "operator", LOOK + CHANGE, RUN_CODE),
    User("cleo", "mauve-admin", "admin", LOOK + CHANGE + RUN_CODE, ()),
    User("dan", "nogroup", "", (), LOOK + CHANGE + RUN_CODE))


class Users:
    """They live as long as the machine."""

    def __init__(self, own):
        self.own = own
        for user in USERS:
            own.shell(f"useradd --no-create-home --groups {user.group} {user.name}")

    def asks(self, user, words):
        """As after a login: mauvectl WORDS."""
        return self.own.run("env", f"MAUVE_SOCKET={SOCKET}", "setpriv", f"--reuid={user.name}", f"--regid={user.name}",
                            "--init-groups", "mauvectl", *words.split())

    def wrong(self):
        """What a user may ask and was refused, or may not ask and was not refused so."""
        for user in USERS:
            for words in user.may:
                said = self.asks(user, words)
                if said.returncode != 0:
                    yield f"{user.name} of {user.group}: {words} ended with {said.returncode}\n{said.stdout}"
            for words in user.may_not:
                said = self.asks(user, words)
                why = "needs role" if user.role else "socket_not_permitted"
                if said.returncode != NOT_PERMITTED or why not in said.stdout:
                    yield f"{user.name} of {user.group}: {words} ended with {said.returncode}\n{said.stdout}"

    def seen(self):
        """(user, role) of each, as mauved shows itself to them; the user without a role sees nothing."""
        for user in USERS:
            if user.role:
                clients = json.loads(self.asks(user, "list clients --json").stdout)["items"]
                yield from ((client["uid"], client["role"]) for client in clients if client["you"])

    def expected(self):
        for user in USERS:
            if user.role:
                yield int(self.own.shell(f"id --user {user.name}")), user.role
