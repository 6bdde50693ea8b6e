#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""mauved gives each client a role by the user and the groups that the kernel reports. So no shipped unit or drop-in has
a setting that makes users nobody, or that runs mauved as a user other than the one that the groups belong to."""
import pathlib
import unittest

UNITS = pathlib.Path(__file__).resolve().parents[3] / "systemd"
MAPPING = {"privateusers", "dynamicuser", "usernamespacepath", "delegatenamespaces"}
OFF = {"", "no", "n", "false", "f", "off", "0"}


def settings(text, comments_too=False):
    """(section, key, value) of each setting of a unit. Of a drop-in, comments_too reads what a user puts in force."""
    section = ""
    for line in text.replace("\\\n", " ").splitlines():
        line = line.strip()
        if comments_too and line[:1] in "#;" and line[1:2] not in ("", " "):
            line = line[1:]
        if line.startswith("["):
            section = line.strip("[]")
        elif line and line[0] not in "#;" and "=" in line:
            key, value = line.split("=", 1)
            yield section, key.strip(), value.strip()


def mapping_settings(text, comments_too=False):
    found = []
    for section, key, value in settings(text, comments_too):
        if section == "Service" and key.lower() in MAPPING and value.lower() not in OFF:
            found.append(f"{key}={value}")
    return found


class Users(unittest.TestCase):
    def test_no_shipped_unit_or_drop_in_maps_users(self):
        files = sorted(UNITS.glob("*.service")) + sorted(UNITS.glob("*.conf"))
        self.assertGreaterEqual(len(files), 4)
        for file in files:
            self.assertEqual(mapping_settings(file.read_text(), file.suffix == ".conf"), [], file.name)

    def test_mauved_runs_as_the_user_and_the_group_that_sysusers_makes(self):
        made = [line.split()[:2] for line in (UNITS / "mauved.sysusers").read_text().splitlines()]
        self.assertIn(["u", "mauve"], made)
        for unit in UNITS.glob("*.service"):
            own = {key: value for _, key, value in settings(unit.read_text()) if key in ("User", "Group")}
            self.assertEqual(own, {"User": "mauve", "Group": "mauve"}, unit.name)

    def test_each_form_of_such_a_setting_is_found(self):
        for line in ("PrivateUsers=yes", "PrivateUsers = true", "privateusers=1", "PrivateUsers=self",
                     "PrivateUsers=identity", "PrivateUsers=\\\n  on", "DynamicUser=yes"):
            self.assertEqual(len(mapping_settings(f"[Unit]\nA=b\n[Service]\n{line}\n")), 1, line)
        for line in ("#PrivateUsers=yes", "PrivateUsers=no", "PrivateUsers=false", "; DynamicUser=yes"):
            self.assertEqual(mapping_settings(f"[Service]\n{line}\n"), [], line)
        self.assertEqual(len(mapping_settings("#[Service]\n# A sentence.\n#PrivateUsers=yes\n", True)), 1)


if __name__ == "__main__":
    unittest.main()
