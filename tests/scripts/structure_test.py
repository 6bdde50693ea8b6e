#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The budgets of the structure really refuse what they say they refuse, and the reader of C++ sees what is there."""
import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "scripts"))
import structure  # noqa: E402
from declarations import functions_of  # noqa: E402

RULES = {"depth": structure.depth_problems, "class": structure.class_problems,
         "parameters": structure.parameter_problems, "folder": structure.folder_problems,
         "definition": structure.definition_problems}


@contextlib.contextmanager
def tree_of(files):
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            file = pathlib.Path(root).resolve() / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        yield structure.Tree(pathlib.Path(root).resolve())


class Structure(unittest.TestCase):
    def problems(self, rule, files):
        with tree_of(files) as tree:
            return list(RULES[rule](tree))

    def refused(self, rule, files, words):
        problems = self.problems(rule, files)
        self.assertTrue(any(words in problem for problem in problems), problems)

    def accepted(self, rule, files):
        self.assertEqual(self.problems(rule, files), [])

    def chain(self, length):
        files = {"libruntime/base/a0.h": "#pragma once\n"}
        for at in range(length):
            files[f"libruntime/base/a{at + 1}.h"] = f'#pragma once\n#include "base/a{at}.h"\n'
        return files

    def test_refuses_own_includes_that_are_deeper_than_twelve(self):
        self.accepted("depth", self.chain(12))
        self.refused("depth", self.chain(13), "libruntime/base/a13.h: its own includes are 13 deep, the limit is 12")

    def test_ends_at_a_circle_of_includes(self):
        self.accepted("depth", {"libruntime/base/a.h": '#include "base/b.h"\n',
                                "libruntime/base/b.h": '#include "base/a.h"\n'})

    def test_refuses_a_class_of_more_than_25_functions(self):
        functions = "".join(f"  void f{at}() const;\n" for at in range(25))
        free = "  A(const A&) = delete;\n  std::function<void(int)> call;\n  int x{(1)};\n"
        self.accepted("class", {"ctl/a.h": f"class A {{\n{functions}{free}}};\n"})
        self.refused("class", {"ctl/a.h": f"class A {{\n{functions}  A() : x_{{1}} {{}}\n}};\n"},
                     "ctl/a.h: class A has 26 functions, the limit is 25")

    def test_refuses_a_function_of_more_than_six_parameters(self):
        self.accepted("parameters", {"ctl/a.h": "int f(int a, int b, int c, int d, int e, std::map<int, int> g);\n"})
        self.refused("parameters", {"ctl/a.h": "\nint f(int a, int b, int c, int d, int e, int g, int h);\n"},
                     "ctl/a.h:2: f has 7 parameters")

    def test_refuses_a_folder_of_more_than_25_files(self):
        files = {f"man/a{at}.h": "" for at in range(25)}
        self.accepted("folder", files)
        self.refused("folder", files | {"man/one_more.h": ""}, "man: holds 26 files, the limit is 25")

    def test_refuses_a_definition_far_from_its_header(self):
        header = "class A {\n  int f(int x);\n};\nint g();\n"
        near = '#include "a.h"\nint A::f(int x) {\n  return x;\n}\nint g() { return 1; }\n'
        self.accepted("definition", {"man/a.h": header, "man/a.cpp": near})
        self.refused("definition", {"man/a.h": header, "man/b.cpp": near},
                     "man/b.cpp:2: A::f is declared in man/a.h; define it in the source that is named like")

    def test_knows_that_a_row_of_the_table_declares_its_handler(self):
        files = {"man/a.h": "int show();\n", "daemon/commands/b.cpp": "int show() { return 1; }\n"}
        row = 'MAUVE_METHOD("object.get", show, viewer, read, reads, "Show", PARAMS(), ANSWER())\n'
        self.refused("definition", files, "daemon/commands/b.cpp:1: show is declared in man/a.h")
        self.accepted("definition", files | {"daemon/protocol/table/a.def": row})

    def test_leaves_what_only_one_source_knows_alone(self):
        self.accepted("definition", {"man/a.h": "int g();\n",
                                     "man/b.cpp": "namespace {\nint g() { return 1; }\n}\nstatic int h() { return 2; }\n"})

    def test_lets_an_exception_fall_but_not_rise(self):
        for value, words in ((30, None), (31, "ceiling of this exception is 30"),
                             (29, "lower the ceiling"), (25, "is no exception any more")):
            problem = structure.ceiling_problem("has {} functions", value, 25, {"a": 30}, "a")
            if words is None:
                self.assertIsNone(problem)
            else:
                self.assertIn(words, problem)


class Reader(unittest.TestCase):
    def names(self, text):
        return [(function.name, function.parameters, function.body) for function in functions_of(text)]

    def test_knows_declarations_and_definitions(self):
        self.assertEqual(self.names("namespace a {\nclass B : public C<int> {\n public:\n  B();\n  ~B();\n"
                                    "  [[nodiscard]] int f(int x = g(1, 2)) const noexcept { return x; }\n"
                                    "  bool operator==(const B&) const;\n  int operator()(int, int);\n};\n"
                                    "int B::f(int) { if (x) { y(); } return 1; }\n}\n"),
                         [("B::B", 0, False), ("B::~B", 0, False), ("B::f", 1, True), ("B::operator==", 1, False),
                          ("B::operator()", 2, False), ("B::f", 1, True)])

    def test_takes_no_member_for_a_function(self):
        self.assertEqual(self.names("struct A {\n  int x = f(3);\n  std::function<int(int)> g;\n  int y{h(1)};\n"
                                    "  using F = int (*)(int);\n  static_assert(sizeof(int) == 4);\n};\n"
                                    "const int kTable[] = {f(1), f(2)};\n"), [])

    def test_reads_on_behind_the_initialisers_of_a_constructor(self):
        self.assertEqual(self.names("A::A(int a) : B(a), c_{a}, d_(f(a)) {\n  g();\n}\nint h() { return 1; }\n"),
                         [("A::A", 1, True), ("h", 0, True)])

    def test_is_not_confused_by_templates_and_comments(self):
        self.assertEqual(self.names("// int no(int);\ntemplate <typename T, std::size_t N = 3>\n"
                                    "requires Good<T>\nvoid f(std::map<int, std::vector<T>> a, const char (&b)[N]);\n"
                                    "template <typename R, typename... P>\nclass A<R(P...)> final {\n  R g(P... p);\n};\n"),
                         [("f", 2, False), ("A::g", 1, False)])


class Figures(unittest.TestCase):
    def test_print_medians_and_the_largest(self):
        output = io.StringIO()
        with tree_of({"man/a.h": "class A {\n void f();\n void g();\n};\n", "man/b.cpp": "void A::f() {}\n"}) as tree, \
                contextlib.redirect_stdout(output):
            structure.figures(tree)
        self.assertIn("functions of a class: median 2, largest 2, 0 of 1 over 25", output.getvalue())
        self.assertIn("header's, all: 1 of 1, 100.0 %", output.getvalue())

    def test_count_lines_of_code_of_each_plugin_with_its_header(self):
        files = {"plugins/a/one.h": "// a comment\nstruct OneShell : mauve::Shell {\n};\n",
                 "plugins/a/one.cpp": '#include "one.h"\n\n/* two\nlines */\nvoid declare(mauve::Plugin& plugin) {\n'
                                      '  plugin.core<One>("one");  // it\n}\n',
                 "plugins/a/two.h": "class Two final : public GuidanceCore {\n};\n",
                 "plugins/a/list.cpp": 'MAUVE_PLUGIN(plugin) { plugin.core<Two>("two"); }\n',
                 "plugins/a/field.h": "struct Field {\n};\n",
                 "daemon/a.h": "class Other final : public Core {\n};\n"}
        with tree_of(files) as tree:
            self.assertEqual(tree.plugin_sizes, {"plugins/a/one": 6, "plugins/a/two": 2})


if __name__ == "__main__":
    unittest.main()
