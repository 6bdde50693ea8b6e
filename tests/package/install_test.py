#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""install_test.py [--stand-in] BEFORE AFTER: packages are installed, upgraded, removed and purged.

BEFORE and AFTER are folders of packages; those of AFTER have the higher version. All happens in a copy of this machine.
Its process 1 is systemd; with --stand-in, or where systemd does not run, only the calls of systemctl are looked at.
Without root the test is skipped.
"""
import json
import pathlib
import re
import sys

import machine
import users

NAMES = ["mauve", "mauve-dev", "mauve-plugins", "mauve-ros1", "mauve-doc"]
DROP_INS = "/etc/systemd/system/mauved.service.d"
CAPABILITIES = f"""
(ulimit -r 99) 2>/dev/null && exit
# This machine may not raise limits, so the unit needs the drop-in for such machines.
mkdir -p {DROP_INS}
dpkg-deb --fsys-tarfile /opt/mauve-test/before/mauve_*.deb |
  tar --extract --to-stdout ./usr/share/doc/mauve/systemd/mauved-capabilities.conf |
  sed -E 's/^#(\\[|[A-Z][A-Za-z]+=)/\\1/' >{DROP_INS}/capabilities.conf
"""
# The unit asks for real time, which a machine that may not raise limits does not give: there the program that the unit
# starts does without. The unit stays as it is.
WITHOUT_REAL_TIME = """
(ulimit -r 99) 2>/dev/null && exit
mv /usr/sbin/mauved /usr/sbin/mauved.real
cat >/usr/sbin/mauved <<'END'
#!/bin/sh
for word; do
  shift
  test "$word" = require && word=prefer
  set -- "$@" "$word"
done
exec /usr/sbin/mauved.real "$@"
END
chmod +x /usr/sbin/mauved
"""
FILE = "/etc/mauve/architecture.json"
SOCKET = "/run/mauve/mauved.sock"
ROLES = {"mauve-view": "viewer", "mauve": "operator", "mauve-admin": "admin"}


def member(group):
    """Runs the command that follows as a user who is in this group only."""
    return f"env MAUVE_SOCKET={SOCKET} setpriv --reuid=nobody --regid=nogroup --groups={group}"


def check(true, what, shown=""):
    print(("ok    " if true else "FAIL  ") + what + (f"\n{shown}" if not true else ""))
    if not true:
        raise AssertionError(what)


def equal(found, wanted, what):
    check(str(found).strip() == str(wanted), f"{what}: {wanted}", f"found: {found}")


class Test:
    def __init__(self, own):
        self.own = own
        self.calls = 0

    def install(self, folder):
        print(self.own.shell(f"dpkg --install --force-confdef /opt/mauve-test/{folder}/*.deb"))

    def version(self):
        return self.own.shell("dpkg-query --show --showformat '${Version}\n' mauve mauve-dev mauve-plugins mauve-doc")

    def step(self):
        """The value that a client sets: 1 in the file."""
        return self.own.shell("mauvectl --wait 20s get counter.core.step").split()[-1]

    def journal(self):
        return self.own.shell("journalctl --unit mauved --no-pager --output cat")

    def state(self):
        return self.own.run("systemctl", "is-active", "mauved").stdout.strip()

    def called(self, *wanted):
        """The stand-in for systemctl was called with these words since the last look, in this order."""
        calls = self.own.shell("cat /run/systemctl.calls").splitlines()
        new, self.calls = calls[self.calls:], len(calls)
        rest = iter(new)
        for words in wanted:
            check(any(words in call for call in rest), f"systemctl is called with: {words}", "\n".join(new))

    def installed(self):
        own = self.own
        for name in ("mauve", "mauve-view", "mauve-admin"):
            own.shell(f"getent group {name}")
        equal(own.shell("getent passwd mauve | cut -d: -f6"), "/var/lib/mauve", "the home of the user mauve")
        equal(own.shell("systemctl is-enabled mauved"), "enabled", "the service is")
        own.shell("command -v systemd-analyze")
        complaints = own.shell("systemd-analyze verify mauved.service mauve-guardian.service 2>&1 | grep -i mauve || true")
        equal(complaints, "", "complaints of systemd-analyze verify")
        own.shell("man --where mauved mauve-guardian mauvectl mauve-stamp mauve-architecture mauve-protocol")
        own.shell("pkg-config --exists 'mauve >= 0.1' && test -f /usr/share/doc/mauve/html/index.html")
        own.shell("test -f /usr/share/doc/mauve-doc/html/index.html")
        own.shell("mauved --check /usr/share/mauve/yard.json")
        libraries = own.shell("for file in /usr/sbin/mauve* /usr/bin/mauve* /usr/lib/mauve/plugins/*.so; do ldd $file; done")
        check("not found" not in libraries, "all libraries are there", libraries)

    def runs(self):
        own = self.own
        equal(self.state(), "active", "the service is")
        own.shell("mauvectl --wait 20s status")
        equal(own.shell("stat --format '%U %a' /var/lib/mauve /run/mauve"), "mauve 750\nmauve 750", "directories")
        self.roles()
        refused = own.run(*member("mauve-view").split(), "mauvectl", "set", "counter.core.step=9")
        check(refused.returncode == 5, "mauve-view may look only", refused.stdout)

    def as_shipped(self):
        """The unit of the package without a drop-in, hardened as it is, gives four users their roles."""
        own = self.own
        own.shell(f"rm -rf {DROP_INS}; systemctl daemon-reload\n{WITHOUT_REAL_TIME}")
        own.shell("systemctl restart mauved && mauvectl --wait 20s status")
        equal(own.shell("systemctl show --property DropInPaths --value mauved"), "", "drop-ins of the unit")
        own.shell('grep -F .service "$(dpkg-query --control-path mauve md5sums)"')  # these are verified
        equal(own.shell("dpkg --verify mauve | grep -F .service || true"), "", "unit files that are not as shipped")
        four = users.Users(own)
        wrong = list(four.wrong())
        check(not wrong, "a viewer, an operator, an admin and a user without a role may ask what they should",
              "\n".join(wrong))
        equal(sorted(four.seen()), sorted(four.expected()), "users and roles that mauved sees")
        own.shell("test ! -e /usr/sbin/mauved.real || mv /usr/sbin/mauved.real /usr/sbin/mauved\n" + CAPABILITIES)
        own.shell("systemctl daemon-reload && systemctl restart mauved && mauvectl --wait 20s status")

    def roles(self):
        """A user in one of the groups opens the socket and gets the role; a user in none of them cannot open it."""
        for group, role in ROLES.items():
            clients = json.loads(self.own.shell(f"{member(group)} mauvectl --wait 20s list clients --json"))
            equal([client["role"] for client in clients["items"] if client["you"]], [role], f"roles of a user in {group}")
        refused = self.own.run(*member("nogroup").split(), "mauvectl", "status")
        check(refused.returncode == 5 and "socket_not_permitted" in refused.stdout,
              "a user in none of the groups may not open the socket", refused.stdout)

    def roles_without_a_service(self):
        """As the unit runs mauved, but without real time."""
        self.own.shell(f"env MAUVE_SOCKET={SOCKET} setpriv --reuid=mauve --regid=mauve --clear-groups"
                       f" mauved {FILE} --realtime off --guardian off >/dev/null 2>&1 & echo $! >/run/mauved.pid")
        self.roles()
        self.own.shell("kill $(cat /run/mauved.pid); while test -e /run/mauve/mauved.sock; do sleep 0.1; done")

    def changed(self, value):
        self.own.shell(f"mauvectl set counter.core.step={value} --probation off")
        equal(self.step(), value, "the step that a client set is")

    def upgraded(self):
        """A running mauved continues, once."""
        own = self.own
        self.changed(5)
        own.shell("systemctl restart mauved")
        equal(self.step(), 1, "after an ordinary restart the step is that of the file")
        self.changed(7)
        before = own.shell("systemctl show --property MainPID --value mauved mauve-guardian")
        own.shell(f"echo '// edited' >>{FILE}")

        self.install("after")

        check(set(re.findall(r"-\d+$", self.version(), re.M)) == {"-2"}, "the packages have the new version")
        after = own.shell("systemctl show --property MainPID --value mauved mauve-guardian")
        check(not set(before.split()) & set(after.split()), "mauved and its guardian were restarted", before + after)
        equal(self.step(), 7, "after the upgrade the step is the one that was confirmed")
        check("an upgrade restarted mauved: starting generation" in self.journal(), "the journal says why", self.journal())
        equal(own.shell(f"tail -1 {FILE}"), "// edited", "the last line of the file is as it was edited")
        own.shell("systemctl restart mauved")
        equal(self.step(), 1, "after the next restart the step is that of the file")

    def upgraded_while_it_rests(self):
        own = self.own
        own.shell("systemctl stop mauved && systemctl disable mauved")
        self.install("after")
        equal(self.state(), "inactive", "a service that was stopped and disabled is")
        equal(own.run("systemctl", "is-enabled", "mauved").stdout, "disabled", "and")
        equal(own.run("ls", "/var/lib/mauve/continue").returncode, 2, "it will not continue; ls ends with")
        own.shell("systemctl enable --now mauved")

    def removed(self):
        own = self.own
        print(own.shell("dpkg --remove mauve-dev mauve-plugins $(dpkg-query --show --showformat '${Package} '"
                        " 'mauve-ros1*') mauve-doc mauve"))
        check(not own.run("test", "-e", "/usr/sbin/mauved").returncode == 0, "mauved is gone")
        own.shell(f"test -f {FILE}")

    def purged(self):
        own = self.own
        print(own.shell("dpkg --purge $(dpkg-query --show --showformat '${Package} ' 'mauve*')"))
        own.shell("test ! -e /etc/mauve && test ! -e /var/lib/mauve && test ! -e /var/log/mauve && test ! -e /run/mauve")
        left = own.shell("cd /run/changed && find usr etc var -name '*mauve*' ! -type c"
                         f" ! -path '{DROP_INS[1:]}*' ! -path 'var/cache/man/*'")
        equal(left, "", "files of mauve that are left")

    def with_systemd(self):
        self.installed()
        self.runs()
        self.as_shipped()
        self.upgraded()
        self.upgraded_while_it_rests()
        self.removed()
        equal(self.state(), "inactive", "the removed service is")
        self.own.shell("test -d /var/lib/mauve/generations")
        self.install("after")
        equal(self.step(), 1, "installed again, mauved runs the file that was kept; its step is")
        self.purged()

    def with_the_stand_in(self):
        self.installed()
        self.called("daemon-reload", "start mauved.service")
        self.roles_without_a_service()
        self.own.shell(f"echo '// edited' >>{FILE}; mkdir /var/lib/mauve && chown mauve:mauve /var/lib/mauve")
        self.install("after")
        self.called("daemon-reload", "is-active mauved.service", "restart mauve-guardian.service mauved.service")
        equal(self.own.shell("stat --format '%U %a' /var/lib/mauve/continue"), "mauve 600", "the new mauved is to continue")
        equal(self.own.shell(f"tail -1 {FILE}"), "// edited", "the last line of the file is as it was edited")
        self.removed()
        self.called("stop mauved.service mauve-guardian.service", "daemon-reload")
        self.purged()


def main():
    missing = machine.missing_for_a_machine()
    if missing:
        print(f"SKIPPED: {missing} is missing, so NO package was installed", file=sys.stderr)
        return 77
    before, after = map(pathlib.Path, sys.argv[-2:])
    for folder in (before, after):
        if not list(folder.glob("mauve_*.deb")):
            sys.exit(f"no packages in {folder}: scripts/package --into {folder} (see scripts/test)")
    with machine.Machine(before, after, stand_in="--stand-in" in sys.argv) as own:
        test = Test(own)
        own.shell(CAPABILITIES)
        test.install("before")
        check(set(re.findall(r"-\d+$", test.version(), re.M)) == {"-1"}, "the packages have the first version")
        try:
            (test.with_systemd if own.has_systemd else test.with_the_stand_in)()
        except AssertionError:
            if own.has_systemd:
                print(own.run("journalctl", "--no-pager", "--lines", "200").stdout)
            raise
    return 0


if __name__ == "__main__":
    sys.exit(main())
