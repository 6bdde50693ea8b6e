#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""install_test.py BUILD LIBDIR VERSION: a build is installed into a prefix with spaces, moved, and uninstalled."""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

BUILD, LIBDIR, VERSION = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
KEPT = "etc/mauve/architecture.json"  # a user edits it, so it stays


def files(prefix):
    return {path.relative_to(prefix).as_posix() for path in prefix.rglob("*") if not path.is_dir()}


def pkg_config(prefix, *words):
    """The words that pkg-config prints."""
    done = subprocess.run(["pkg-config", "--print-errors", *words], capture_output=True, text=True, check=True,
                          env={**os.environ, "PKG_CONFIG_PATH": str(prefix / LIBDIR / "pkgconfig")})
    return shlex.split(done.stdout)


class Installation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.prefix = pathlib.Path(cls.place.name) / "100% my robot"
        environment = {name: value for name, value in os.environ.items() if name != "DESTDIR"}
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.prefix], check=True, env=environment,
                       stdout=subprocess.DEVNULL)
        cls.manifest = (BUILD / "install_manifest.txt").read_text("utf-8").splitlines()

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def knows_its_folders(self, prefix):
        self.assertEqual(pkg_config(prefix, "--modversion", "mauve"), [VERSION])
        include = [word[2:] for word in pkg_config(prefix, "--cflags", "mauve") if word.startswith("-I")]
        self.assertTrue((pathlib.Path(include[0]) / "mauve/plugin.h").is_file(), include)
        library = [word[2:] for word in pkg_config(prefix, "--libs", "mauve") if word.startswith("-L")]
        self.assertTrue((pathlib.Path(library[0]) / "libmauve.so").is_file(), library)
        plugins = " ".join(pkg_config(prefix, "--variable=plugindir", "mauve"))
        self.assertTrue((pathlib.Path(plugins) / "types.so").is_file(), plugins)

    def test_1_pkg_config_knows_its_folders(self):
        self.knows_its_folders(self.prefix)
        subprocess.run(["pkg-config", "--exists", f"mauve >= {VERSION}"], check=True,
                       env={**os.environ, "PKG_CONFIG_PATH": str(self.prefix / LIBDIR / "pkgconfig")})

    def test_2_units_start_the_programs_of_the_prefix(self):
        units = sorted(self.prefix.rglob("*.service"))
        self.assertEqual(len(units), 2)
        folder = str(self.prefix / "sbin").replace("%", "%%")
        for unit in units:
            started = re.findall(r"^Exec\w+=(.*)$", unit.read_text("utf-8"), re.M)
            self.assertGreater(len(started), 0)
            for line in started:
                self.assertEqual(pathlib.Path(shlex.split(line)[0]).parent, pathlib.Path(folder))

    def test_3_programs_among_the_data_are_executable(self):
        scripts = sorted((self.prefix / "share/mauve").rglob("*.py"))
        self.assertGreater(len(scripts), 2)
        self.assertEqual([path.name for path in scripts if not os.access(path, os.X_OK)], [])

    def test_4_the_manifest_has_every_file(self):
        listed = {os.path.relpath(path, self.prefix) for path in self.manifest}
        self.assertEqual(files(self.prefix) ^ listed, {KEPT})

    def test_5_a_prefix_that_moved_works(self):
        moved = self.prefix.parent / "another place"
        self.prefix.rename(moved)
        try:
            self.knows_its_folders(moved)
            self.assertIn(VERSION, subprocess.run([moved / "bin/mauvectl", "version"], capture_output=True, text=True,
                                                  check=False).stdout)
        finally:
            moved.rename(self.prefix)

    def test_6_what_the_page_prints_uninstalls_it(self):
        page = (pathlib.Path(__file__).parents[2] / "docs/how-to/install-packages.md").read_text("utf-8")
        command = re.search(r"^<!-- run by tests/external/install_test.py -->\n```sh\n(.*?)```", page, re.M | re.S)[1]
        self.assertIn("build/release", command)
        with tempfile.TemporaryDirectory() as tree:
            os.makedirs(f"{tree}/build")
            os.symlink(BUILD, f"{tree}/build/release")
            subprocess.run(["bash", "-ec", command], cwd=tree, check=True)
        self.assertEqual(files(self.prefix), {KEPT})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
