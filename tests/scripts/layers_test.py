#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The include rules, the size budget and the promises really refuse what they say they refuse."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts"


def run(script, files):
    """Exit code and output of a script on a tree that holds just these files."""
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            file = pathlib.Path(root) / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        done = subprocess.run([sys.executable, SCRIPTS / script, root], capture_output=True,
                              text=True, check=False)
        return done.returncode, done.stdout + done.stderr


class Layers(unittest.TestCase):
    def refused(self, files, words):
        code, output = run("layers.py", files)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def accepted(self, files):
        code, output = run("layers.py", files)
        self.assertEqual(code, 0, output)

    def test_accepts_an_include_along_an_arrow(self):
        self.accepted({"libruntime/rt/clock.h": "#pragma once\n",
                       "libruntime/exec/task.cpp": '#include "rt/clock.h"\n#include <vector>\n'})

    def test_refuses_a_lower_layer_that_knows_a_higher_one(self):
        self.refused({"libruntime/exec/task.h": "#pragma once\n",
                      "libruntime/model/element/fsm.cpp": '\n#include "exec/task.h"\n'},
                     "libruntime/model/element/fsm.cpp:2: layer model may use")

    def test_refuses_neighbours_that_must_not_know_each_other(self):
        self.refused({"libruntime/exec/task.h": "", "libruntime/plugin/a.cpp": '#include "exec/task.h"\n'},
                     "not exec")

    def test_refuses_a_header_of_a_layer_that_may_be_used_in_part_only(self):
        headers = {"libruntime/rt/process/process.h": "", "libruntime/rt/time/clock.h": "",
                   "daemon/log/events.def": "", "daemon/log/log.h": ""}
        self.accepted({**headers, "ctl/a.cpp": '#include "log/events.def"\n#include "rt/process/process.h"\n'})
        self.refused({**headers, "ctl/a.cpp": '#include "log/log.h"\n'},
                     "ctl/a.cpp:1: layer ctl may use of log only daemon/log/events.def, not daemon/log/log.h")
        self.refused({**headers, "ctl/a.cpp": '#include "rt/time/clock.h"\n'}, "not libruntime/rt/time/clock.h")

    def test_refuses_a_guardian_that_uses_more_than_its_messages(self):
        self.refused({"libruntime/exec/task.h": "", "guardian/a.cpp": '#include "exec/task.h"\n'},
                     'layer guardian may use "rt base", not exec')
        self.refused({"libruntime/base/mutex.h": "", "guardian/a.cpp": '#include "base/mutex.h"\n'},
                     "guardian/a.cpp:1: layer guardian may use of base only libruntime/base/standard_streams.h")
        self.refused({"libruntime/rt/time/clock.h": "", "guardian/a.cpp": '#include "rt/time/clock.h"\n'},
                     "layer guardian may use of rt only libruntime/rt/guardian/guardian_wire.h")

    def test_refuses_a_room_that_knows_a_higher_one_of_its_layer(self):
        self.accepted({"libruntime/exec/task/task.h": "#pragma once\n",
                       "libruntime/exec/commit/commit.cpp": '#include "exec/task/task.h"\n'})
        self.refused({"libruntime/exec/commit/commit.h": "#pragma once\n",
                      "libruntime/exec/task/task.cpp": '#include "exec/commit/commit.h"\n'},
                     "room task is below commit and may not use it")
        self.refused({"libruntime/exec/task/task.h": "#pragma once\n",
                      "libruntime/exec/other.cpp": '#include "exec/task/task.h"\n'}, "is in no room of libruntime/exec")

    def test_refuses_a_plugin_or_example_that_uses_a_header_of_the_runtime(self):
        headers = {"libruntime/include/mauve/job.h": "", "libruntime/include/mauve/detail/job.h": ""}
        for folder in ("plugins", "examples"):
            self.accepted({**headers, f"{folder}/a/a.cpp": "#include <mauve/job.h>\n"})
            self.refused({**headers, f"{folder}/a/a.cpp": "#include <mauve/detail/job.h>\n"},
                         f"{folder}/a/a.cpp:1: <mauve/detail/job.h> is for the runtime; authors include mauve/*.h")
            self.refused({f"{folder}/a/a.cpp": "int x = mauve::detail::kHashSeed;\n"}, "authors use names of mauve")
        self.accepted({**headers, "daemon/a.cpp": "#include <mauve/detail/job.h>\n"})

    def test_refuses_a_public_header_with_a_private_include(self):
        self.refused({"libruntime/rt/clock.h": "", "libruntime/include/mauve/x.h": '#include "rt/clock.h"\n'},
                     "layer public may use")

    def test_refuses_a_plugin_that_looks_behind_the_public_headers(self):
        self.refused({"libruntime/rt/clock.h": "", "plugins/a/a.cpp": '#include "rt/clock.h"\n'},
                     "layer plugins may use")

    def test_sees_a_relative_include(self):
        self.refused({"libruntime/exec/task.h": "",
                      "libruntime/rt/time/clock.cpp": '#include "../exec/task.h"\n'}, "not exec")

    def test_refuses_a_library_outside_its_room(self):
        self.refused({"libruntime/model/a.cpp": "#include <nlohmann/json.hpp>\n"},
                     "<nlohmann/json.hpp> belongs in libruntime/arch/")
        self.refused({"libruntime/exec/a.cpp": "#include <dlfcn.h>\n"}, "belongs in libruntime/plugin/")

    def test_accepts_a_library_in_its_room(self):
        self.accepted({"libruntime/arch/parse/parse.cpp": "#include <nlohmann/json.hpp>\n",
                       "tests/unit/a_test.cpp": "#include <gtest/gtest.h>\n"})

    def test_refuses_a_file_in_no_layer(self):
        self.refused({"libruntime/utils/a.h": ""}, "is in no layer")

    def test_refuses_a_member_whose_string_differs(self):
        self.refused({"plugins/a/a.cpp": 'Property<double> gain{*this, "gian", 1};\n'},
                     'member gain is registered as "gian"')

    def test_refuses_a_parameter_whose_string_differs_from_its_field(self):
        self.refused({"plugins/a/a.cpp": 'parameter("gain", &Gains::gain), mauve::parameter("gian",\n &a::Gains::gain)\n'},
                     'a.cpp:1: member gain is registered as "gian"')
        self.accepted({"plugins/a/a.cpp": 'parameter(/*as in the paper*/ "k", &Gains::gain)\n'})

    def test_accepts_another_name_that_is_meant_and_names_in_comments(self):
        self.accepted({"plugins/a/a.cpp": 'Property<double> gain{*this, /*as in the paper*/ "k", 1};\n'
                                          '// gain{*this, "k"} would be refused\n/* gain{*this, "k"} too */\n'})

    def test_names_the_line_of_a_member_behind_comments_and_strings(self):
        self.refused({"plugins/a/a.cpp": '/* two\nlines */ char a = \'"\'; auto b = "//";\n'
                                         'Property<double> gain{\n    *this, "gian", 1};\n'},
                     'plugins/a/a.cpp:3: member gain is registered as "gian"')

    def test_accepts_members_whose_strings_agree(self):
        self.accepted({"plugins/a/a.cpp": 'Sync idle{*this, "idle", 1}, pace_{*this, "pace", 2};\n'})

    def test_refuses_a_loop_over_rows_of_an_answer_that_has_no_name(self):
        self.refused({"tests/a.cpp": 'for (const auto& row : daemon.ask("status.get")["items"]) {\n}\n'},
                     "a.cpp:1: give the answer a name")


class Lines(unittest.TestCase):
    def refused(self, files, words):
        code, output = run("lines.py", files)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def test_refuses_a_long_header_source_and_line(self):
        self.refused({"ctl/a.h": "\n" * 251}, "251 lines, the limit is 250")
        self.refused({"ctl/a.cpp": "\n" * 401}, "401 lines, the limit is 400")
        self.refused({"ctl/a.cpp": "//" + "x" * 99 + "\n"}, "101 columns")

    def test_refuses_a_long_function_also_inside_a_class(self):
        body = "  int x;\n" * 60
        self.refused({"ctl/a.cpp": f"void f(int a) {{\n{body}}}\n"}, "a.cpp:1: function of 62 lines")
        self.refused({"ctl/a.cpp": f"class A {{\n void f() const {{\n{body}}}\n}};\n"},
                     "a.cpp:2: function of 62 lines")

    def test_does_not_take_a_namespace_or_class_for_a_function(self):
        body = "int f();\n" * 90
        for head in ("namespace a", "class [[nodiscard]] A", "struct A : B<int()>"):
            code, output = run("lines.py", {"ctl/a.cpp": f"{head} {{\n{body}}};\n"})
            self.assertEqual(code, 0, output)

    def test_is_not_confused_by_braces_in_strings_and_comments(self):
        body = 'f("{"); g(\'{\'); h(R"({{)"); // {\n /* { */ int big = 1\'000;\n'
        code, output = run("lines.py", {"ctl/a.cpp": f"void f() {{\n{body}}}\n" * 30})
        self.assertEqual(code, 0, output)


class Promises(unittest.TestCase):
    def check(self, row):
        head = "# What you can rely on\n## Promises\n| promise | figure and command | tests |\n|---|---|---|\n"
        return run("promises.py", {"docs/promises.md": head + row + "\n\n## Next\n",
                                   "tests/a_test.cpp": "TEST(Swap, Works) {\n}\n"})

    def refused(self, row, words):
        code, output = self.check(row)
        self.assertEqual(code, 1, output)
        self.assertIn(words, output)

    def test_accepts_a_promise_with_figure_command_and_test(self):
        code, output = self.check("| it works | 3 of 3 · `ctest -R Swap` | `Swap.Works` |")
        self.assertEqual(code, 0, output)

    def test_refuses_a_test_that_is_not_there(self):
        self.refused("| it works | 3 of 3 · `ctest` | `Swap.Fails` |", "there is no such test")

    def test_refuses_a_promise_without_figure_or_command(self):
        for cell in ("", "3 of 3", "`ctest -R Swap`", "· `ctest -R Swap`"):
            self.refused(f"| it works | {cell} | `Swap.Works` |", "no figure with a command")

    def test_refuses_a_promise_without_a_cell_for_the_figure(self):
        self.refused("| it works | `Swap.Works` |", "2 cells instead of")


if __name__ == "__main__":
    unittest.main()
