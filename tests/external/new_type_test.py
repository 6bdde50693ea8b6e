#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""new_type_test.py PREFIX: the commands of docs/concepts/data-exchange.md that change the type of a value on a running robot.

The page has the plugin axis, which goes from axis_setpoint/1 to axis_setpoint/2. Here is one that does.
"""
import json
import pathlib
import re
import shutil
import sys
import tempfile

import page_test

PAGE = pathlib.Path(__file__).parents[2] / "docs/concepts/data-exchange.md"
CMAKE = """cmake_minimum_required(VERSION 3.25)
project(axis LANGUAGES CXX)
find_package(mauve REQUIRED)
mauve_add_plugin(axis SOURCES axis.cpp)
"""
OLD = """
struct Setpoint {
  double degrees = 0;
  static constexpr std::string_view type_name = "axis_setpoint/1";
  static constexpr auto fields() { return std::tuple{mauve::field("degrees", &Setpoint::degrees)}; }
};
#define TURNED(setpoint) (setpoint).degrees
"""
NEW = OLD.split("#define")[0].replace("Setpoint", "SetpointV1") + """
struct Setpoint {
  double radians = 0;
  static constexpr std::string_view type_name = "axis_setpoint/2";
  static constexpr auto fields() { return std::tuple{mauve::field("radians", &Setpoint::radians)}; }
  using Before = SetpointV1;
  static void convert(const SetpointV1& old, Setpoint& now) noexcept { now.radians = old.degrees / 180; }
};
#define TURNED(setpoint) (setpoint).radians
"""
PLUGIN = """#include <mauve/plugin.h>
%s
struct MotionShell : mauve::Shell {
  mauve::WritePort<Setpoint> setpoint{*this, "setpoint"};
};
struct Motion : mauve::Core<MotionShell> {
  mauve::Stateless stateless{*this};
  void update() {
    Setpoint next;
    TURNED(next) = 90;
    shell().setpoint.write(next);
  }
};
struct DriveShell : mauve::Shell {
  mauve::ReadPort<Setpoint> setpoint{*this, "setpoint"};
};
struct Drive : mauve::Core<DriveShell> {
  mauve::Observable<double> angle{*this, "angle", 0.0, "turned to"};
  mauve::Stateless stateless{*this};
  void update() { angle = TURNED(shell().setpoint.read()); }
};
MAUVE_PLUGIN(plugin) {
  %s
  plugin.type<Setpoint>();
  plugin.component<MotionShell, Motion, mauve::PeriodicFsm<Motion>>("motion");
  plugin.component<DriveShell, Drive, mauve::PeriodicFsm<Drive>>("drive");
}
"""
FILE = {"schema": "mauve/architecture/1", "name": "axis", "plugins": ["axis"],
        "resources": {"setpoint": {"type": "shared_data", "data": "axis_setpoint/1"}},
        "components": {
            "motion": {"type": "axis/motion", "task": {"priority": 40}, "ports": {"setpoint": "setpoint.write"}},
            "drive": {"type": "axis/drive", "task": {"priority": 30}, "ports": {"setpoint": "setpoint.read"}}}}


def write_project(home):
    """The plugin in both revisions, and both files."""
    (home / "CMakeLists.txt").write_text(CMAKE)
    (home / "1.cpp").write_text(PLUGIN % (OLD, ""))
    (home / "2.cpp").write_text(PLUGIN % (NEW, "plugin.type<SetpointV1>();"))
    (home / "old.json").write_text(json.dumps(FILE))
    new = json.loads(json.dumps(FILE))
    new["resources"]["setpoint"]["data"] = "axis_setpoint/2"
    new["components"]["motion"]["start"] = False
    (home / "new.json").write_text(json.dumps(new))


def printed():
    """The commands of the page."""
    found = re.search(r"^<!-- run by tests/external/new_type_test.py -->\n```sh\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)
    return [command for command, _ in page_test.lines_of(found[1])]


def main():
    home = pathlib.Path(tempfile.mkdtemp(prefix="mauve_home_"))
    try:
        (home / "mauve").symlink_to(sys.argv[1])
        write_project(home)
        build = "cmake --build build >build.log 2>&1 || { cat build.log; false; }"
        steps = [
            "export MAUVE=$HOME/mauve MAUVE_SOCKET=$HOME/mauve.sock CMAKE_PREFIX_PATH=$HOME/mauve",
            "export PATH=$MAUVE/bin:$MAUVE/sbin:$PATH",
            f"cp 1.cpp axis.cpp && cmake -B build >build.log && {build}",
            "mauved old.json --plugin-dir build >mauved.log 2>&1 &",
            "mauvectl --wait 60s wait --for 'drive.core.angle == 90' --timeout 60s",
            f"cp 2.cpp axis.cpp && {build}",
            *printed()[:-1],
            "mauvectl wait --for 'drive.core.angle == 0.5' --timeout 60s",  # the old value, converted
            printed()[-1],
            "mauvectl wait --for 'drive.core.angle == 90' --timeout 60s"]
        done, output = page_test.run("true", steps, str(home))
        wrong = list(page_test.judge([[step, []] for step in steps], done))
        if wrong:
            print(output.replace(page_test.MARK, "exit "), (home / "mauved.log").read_text(), *wrong, sep="\n")
        return 1 if wrong or len(printed()) < 5 else 0
    finally:
        shutil.rmtree(home, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
