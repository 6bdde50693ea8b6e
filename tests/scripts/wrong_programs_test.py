#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""A wrong program of an author is one clear sentence of the compiler, and the documented listings
compile. Arguments: a compiler, the folder of the public headers."""
import re
import subprocess
import sys
import unittest

COMPILER, HEADERS = sys.argv.pop(1), sys.argv.pop(1)

HEADER = """
#include <mauve/plugin.h>
namespace robot {
struct Shell : mauve::Shell {
  mauve::WritePort<double> out{*this, "out"};
};
struct OtherShell : mauve::Shell {};
struct Contract : mauve::Core<Shell> {
  virtual void step() = 0;
  virtual bool ready() { return true; }
};
struct Good : Contract {
  using Contract = robot::Contract;
  void step() override {}
};
struct Forgetful : Contract {
  using Contract = robot::Contract;
};
struct Fsm : mauve::Fsm<Contract> {
  Exec work{*this, "work", &Contract::step};
  Sync pause{*this, "pause", 100ms};
  mauve::Status on_configure() override {
    start_at(work);
    work.when(&Contract::ready, pause).then(pause);
    pause.then(work);
    return mauve::ok();
  }
};
%s
}  // namespace robot
using namespace robot;
MAUVE_PLUGIN(plugin) { %s }
"""

LISTING = """
#include <mauve/host/architecture.h>
#include <mauve/plugin.h>
struct Scan { double range = 0; };
struct ScannerShell : mauve::Shell {
  mauve::Property<std::string> device{*this, "device", "/dev/null"};
  mauve::WritePort<Scan> scan{*this, "scan"};
};
struct Scanner : mauve::Core<ScannerShell> { void update() {} };
struct Navigation : mauve::Architecture {
  mauve::Component<ScannerShell, Scanner, mauve::PeriodicFsm<Scanner>> hokuyo{*this, "hokuyo"};
  mauve::SharedData<Scan> scan{*this, "scan"};
  mauve::Status on_configure() override {
    hokuyo.shell().scan.connect(scan.write_service());
    hokuyo.shell().device = "/dev/hokuyo";
    hokuyo.fsm().period = 25ms;
    return mauve::ok();
  }
};
int main() { return Navigation().configure() ? 0 : 1; }
"""


def compile_text(text, *options):
    """Exit code of the compiler, and its errors without what it notes beside them."""
    done = subprocess.run(
        [COMPILER, "-std=c++20", "-fsyntax-only", f"-I{HEADERS}", "-x", "c++", *options, "-"],
        input=text, capture_output=True, text=True, check=False)
    return done.returncode, re.findall(r"error: (.*)", done.stderr), done.stderr


class WrongPrograms(unittest.TestCase):
    def refused(self, sentence, members="", body="", most_errors=3):
        code, errors, output = compile_text(HEADER % (members, body))
        self.assertNotEqual(code, 0)
        self.assertIn(sentence, errors[0], output)
        self.assertLessEqual(len(errors), most_errors, output)

    def test_the_listings_of_the_headers_compile(self):
        body = ('plugin.component<Shell, Good, Fsm>("good");'
                'plugin.core<Good>("other"); plugin.fsm<Fsm>("fsm");')
        code, _, output = compile_text(HEADER % ("", body))
        self.assertEqual(code, 0, output)
        code, _, output = compile_text(LISTING)
        self.assertEqual(code, 0, output)

    def test_an_execution_state_of_a_method_that_returns_bool(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     "struct Bad : mauve::Fsm<Contract> {"
                     ' Exec work{*this, "work", &Contract::ready}; };', "(void)Bad();")

    def test_an_execution_state_without_its_owner(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     "struct Bad : mauve::Fsm<Contract> {"
                     ' Exec work{"work", &Contract::step}; };', "(void)Bad();")

    def test_an_execution_state_without_its_name(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     "struct Bad : mauve::Fsm<Contract> {"
                     ' Exec work{*this, &Contract::step}; };', "(void)Bad();")

    def test_a_synchronization_state_without_a_unit(self):
        self.refused("with a duration that has a unit",
                     "struct Bad : mauve::Fsm<Contract> {"
                     ' Sync pause{*this, "pause", 100}; };', "(void)Bad();")

    def test_a_guard_that_returns_nothing(self):
        self.refused("when() takes a method `bool f()` of the contract class",
                     "struct Bad : Fsm { void f() {"
                     " work.when(&Contract::step, pause); } };", "(void)Bad();")

    def test_a_property_without_its_owner(self):
        self.refused("a property is declared as `Property<T> NAME{*this, ",
                     'struct Bad : mauve::Shell { mauve::Property<double> gain{"gain", 0.2}; };',
                     "(void)Bad();")

    def test_a_property_with_a_default_of_another_type(self):
        self.refused("with a default of its type",
                     "struct Bad : mauve::Shell {"
                     ' mauve::Property<double> gain{*this, "gain", "0.2"}; };', "(void)Bad();")

    def test_an_abstract_core_and_the_functions_that_it_lacks(self):
        code, errors, output = compile_text(HEADER % ("", 'plugin.core<Forgetful>("core");'))
        self.assertNotEqual(code, 0)
        self.assertIn("this class is abstract, so no object of it can be made", errors[0], output)
        self.assertIn("step()", output)
        self.assertNotIn("stl_construct.h", output)

    def test_a_component_of_another_shell(self):
        self.refused("this state machine calls cores of another shell", "",
                     'plugin.component<OtherShell, Good, Fsm>("bad");')

    def test_a_component_whose_core_has_another_contract(self):
        self.refused("this core fulfils another contract than its state machine calls",
                     "struct Alone : mauve::Core<Shell> { void step() {} };",
                     'plugin.component<Shell, Alone, Fsm>("bad");')

    def test_a_component_whose_classes_are_in_another_order(self):
        self.refused("the first class of a component is its shell", "",
                     'plugin.component<Good, Fsm>("bad");', 9)

    def test_an_older_standard(self):
        code, errors, output = compile_text(HEADER % ("", ""), "-std=c++17")
        self.assertNotEqual(code, 0)
        self.assertIn("mauve needs C++20: compile with -std=c++20", errors[0], output)


if __name__ == "__main__":
    unittest.main()
