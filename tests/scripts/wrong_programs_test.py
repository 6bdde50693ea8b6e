#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""A wrong program of an author is one clear sentence of the compiler, and the documented listings
compile. Arguments: a compiler, the folder of the public headers."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

COMPILER, HEADERS = sys.argv.pop(1), sys.argv.pop(1)

HEADER = """
#include <mauve/plugin.h>
#include <vector>
namespace robot {
struct Plain { double x = 0; };
struct Old { int x = 0; };
struct Now { double x = 0; };
struct Shell : mauve::Shell {
  mauve::WritePort<double> out{*this, "out"};
};
struct OtherShell : mauve::Shell {};
struct Walker : mauve::Core<Shell> {
  using Contract = Walker;
  virtual void step() = 0;
  virtual bool ready() { return true; }
};
struct Good : Walker {
  void step() override {}
};
struct Forgetful : Walker {};
struct Fsm : mauve::Fsm<Walker> {
  Exec work{*this, "work", &Walker::step};
  Sync pause{*this, "pause", 100ms};
  mauve::Status on_configure() override {
    start_at(work);
    work.when(&Walker::ready, pause).then(pause);
    pause.then(work);
    return mauve::ok();
  }
};
struct Tank : mauve::Core<mauve::EmptyShell> {
  double level() { return 1; }
  void fill(const double&) {}
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


FOLDER = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with
COMMON = pathlib.Path(FOLDER.name) / "common.h"


def setUpModule():
    """Most programs begin with the same headers, which are compiled once."""
    COMMON.write_text("#include <mauve/plugin.h>\n#include <vector>\n", encoding="utf-8")
    subprocess.run([COMPILER, "-std=c++20", f"-I{HEADERS}", "-x", "c++-header", COMMON, "-o", f"{COMMON}.gch"],
                   check=True)


def compile_text(text, *options):
    """Exit code of the compiler, and its errors without what it notes beside them."""
    precompiled = [] if options else ["-include", str(COMMON)]
    done = subprocess.run(
        [COMPILER, "-std=c++20", "-fsyntax-only", f"-I{HEADERS}", "-x", "c++", *precompiled, *options, "-"],
        input=text, capture_output=True, text=True, check=False)
    return done.returncode, re.findall(r"error: (.*)", done.stderr), done.stderr


class WrongPrograms(unittest.TestCase):
    def refused(self, sentence, members="", body=""):
        """The sentence comes first, and at most one more error and a screen of places follow it."""
        code, errors, output = compile_text(HEADER % (members, body))
        self.assertNotEqual(code, 0)
        self.assertIn(sentence.replace('"', '\\"') if "clang" in COMPILER else sentence, errors[0], output)
        self.assertLessEqual(len(errors), 2, output)
        self.assertLessEqual(len(output.splitlines()), 45, output)

    def refused_in_a_core(self, sentence, member):
        self.refused(sentence, "struct Bad : mauve::Core<Shell> { %s void update() {} };" % member,
                     'plugin.core<Bad>("bad");')

    def refused_in_a_shell(self, sentence, member):
        self.refused(sentence, "struct Bad : mauve::Shell { %s };" % member, "(void)Bad();")

    def refused_in_an_interface(self, sentence, member):
        self.refused(sentence, "struct Bad : mauve::Interface<Tank> { %s };" % member, "(void)Bad();")

    def refused_description(self, sentence, description):
        self.refused(sentence, "}\nstruct Data { double x = 0; };\ntemplate <> struct mauve::Described<Data> {"
                     " %s };\nnamespace robot {" % description, "plugin.type<Data>();")

    def test_the_listings_of_the_headers_compile(self):
        body = ('plugin.component<Shell, Good, Fsm>("good");'
                'plugin.core<Good>("other"); plugin.fsm<Fsm>("fsm");')
        code, _, output = compile_text(HEADER % ("", body))
        self.assertEqual(code, 0, output)
        code, _, output = compile_text(LISTING)
        self.assertEqual(code, 0, output)

    def test_an_execution_state_of_a_method_that_returns_bool(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     "struct Bad : mauve::Fsm<Walker> {"
                     ' Exec work{*this, "work", &Walker::ready}; };', "(void)Bad();")

    def test_an_execution_state_without_its_owner(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     "struct Bad : mauve::Fsm<Walker> {"
                     ' Exec work{"work", &Walker::step}; };', "(void)Bad();")

    def test_an_execution_state_without_its_name(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     "struct Bad : mauve::Fsm<Walker> {"
                     ' Exec work{*this, &Walker::step}; };', "(void)Bad();")

    def test_a_synchronization_state_without_a_unit(self):
        self.refused("with a duration that has a unit",
                     "struct Bad : mauve::Fsm<Walker> {"
                     ' Sync pause{*this, "pause", 100}; };', "(void)Bad();")

    def test_a_guard_that_returns_nothing(self):
        self.refused("when() takes a method `bool f()` of the contract class",
                     "struct Bad : Fsm { void f() {"
                     " work.when(&Walker::step, pause); } };", "(void)Bad();")

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

    def test_a_state_machine_of_an_abstract_class_that_is_no_contract(self):
        members = ("struct Base : mauve::Core<Shell> { virtual void update() = 0; };"
                   "struct Alone : Base { void update() override {} };")
        for body in ('plugin.core<Alone>("core"); plugin.component<Shell, mauve::PeriodicFsm<Base>>("bad", "core");',
                     'plugin.component<Shell, Alone, mauve::PeriodicFsm<Base>>("bad");',
                     'plugin.fsm<mauve::PeriodicFsm<Base>>("bad");'):
            self.refused("so other cores derive from it: let it say `using Contract = ITS_NAME;`", members, body)

    def test_a_component_whose_classes_are_in_another_order(self):
        self.refused("the first class of a component is its shell", "",
                     'plugin.component<Good, Fsm>("bad");')

    def test_a_component_whose_last_class_is_no_state_machine(self):
        for classes in ("Shell, Good, Good", "Shell, Good"):
            self.refused("the last class of a component is its state machine", "",
                         f'plugin.component<{classes}>("bad");')

    def test_a_component_whose_second_class_is_no_core(self):
        self.refused("the second class of a component is its core", "",
                     'plugin.component<Shell, Plain, Fsm>("bad");')

    def test_a_core_that_is_no_core(self):
        self.refused("a core derives publicly from mauve::Core<YourShell>", "", 'plugin.core<Plain>("bad");')
        self.refused("a core derives publicly from mauve::Core<YourShell>",
                     "class Bad : mauve::Core<Shell> { public: void update() {} };", 'plugin.core<Bad>("bad");')

    def test_a_core_whose_shell_is_no_shell(self):
        self.refused("the class in mauve::Core<...> is a shell", "struct Bad : mauve::Core<Plain> {};",
                     'plugin.core<Bad>("bad");')

    def test_a_core_that_does_not_derive_from_its_contract(self):
        self.refused("a core derives from its contract class",
                     "struct Bad : mauve::Core<Shell> { using Contract = robot::Walker; };",
                     'plugin.core<Bad>("bad");')

    def test_a_core_with_arguments(self):
        self.refused("an element is made without arguments", "struct Bad : Good { explicit Bad(int) {} };",
                     'plugin.core<Bad>("bad");')

    def test_a_periodic_core_without_update(self):
        for update in ("", "private: void update() {}", "bool update() { return true; }"):
            self.refused("PeriodicFsm runs the public method `void update()` of the core",
                         "struct Bad : mauve::Core<Shell> { %s };" % update,
                         'plugin.component<Shell, Bad, mauve::PeriodicFsm<Bad>>("bad");')

    def test_a_state_machine_that_is_none(self):
        self.refused("a state machine derives publicly from mauve::Fsm", "", 'plugin.fsm<Plain>("bad");')

    def test_a_state_machine_of_a_class_that_is_no_core(self):
        self.refused("a core derives publicly from mauve::Core<YourShell>",
                     "struct Bad : mauve::Fsm<Plain> {};", 'plugin.fsm<Bad>("bad");')

    def test_an_execution_state_of_another_core(self):
        self.refused("an execution state is declared as `Exec NAME{*this, ",
                     'struct Bad : mauve::Fsm<Walker> { Exec work{*this, "work", &Tank::level}; };',
                     "(void)Bad();")

    def test_a_property_of_a_type_without_description(self):
        for kind in ("Plain", "std::vector<int>", "const char*"):
            self.refused_in_a_core("the type of a property is a bool, a number, std::string",
                                   'mauve::Property<%s> bad{*this, "bad", {}};' % kind)

    def test_a_property_without_a_default(self):
        self.refused_in_a_core("with a default of its type", 'mauve::Property<double> bad{*this, "bad"};')

    def test_an_observable_that_is_no_number(self):
        self.refused_in_a_core("an observable is a number or a boolean",
                               'mauve::Observable<std::string> bad{*this, "bad"};')

    def test_an_observable_without_its_owner(self):
        self.refused_in_a_core('`Observable<T> NAME{*this, "NAME"};`', 'mauve::Observable<double> bad{"bad"};')

    def test_a_state_in_a_shell(self):
        self.refused_in_a_shell("a state is a member of a core", "mauve::State<Plain> bad{*this};")
        self.refused_in_a_shell("a slow state is a member of a core", "mauve::SlowState<Plain> bad{*this};")
        self.refused_in_a_shell("Stateless is a member of a core", "mauve::Stateless bad{*this};")

    def test_a_state_with_a_name_or_without_its_owner(self):
        for arguments in ('{*this, "bad"}', ""):
            self.refused_in_a_core("declared as `State<T> NAME{*this};`", f"mauve::State<Plain> bad{arguments};")

    def test_a_slow_state_with_a_first_value(self):
        self.refused_in_a_core("on_configure() gives it its value with set()",
                               "mauve::SlowState<Plain> bad{*this, Plain{}};")

    def test_a_converter_that_does_not_fit_its_state(self):
        for state, function in (("State<Now>", "[](const Old&, Now&) {}"),  # may throw
                                ("State<Now>", "[](const Now&, Old&) noexcept {}"),
                                ("State<Now>", "[](const Old&) noexcept { return Now{}; }"),
                                ("State<Now>", "[this](const Old&, Now&) noexcept { (void)this; }"),
                                ("State<Plain>", "[](const Old&, Now&) noexcept {}"),
                                ("SlowState<Now>", "[](const Now&, Old&) {}")):
            self.refused_in_a_core("a converter is declared after its state as `Converts<Old, Now> NAME{STATE, ",
                                   "mauve::%s state{*this}; mauve::Converts<Old, Now> bad{state, %s};"
                                   % (state, function))

    def test_a_converter_of_data_on_the_heap(self):
        self.refused_in_a_core("plain bytes only", "struct Heap { std::vector<int> all; };"
                               " mauve::State<Heap> state{*this};"
                               " mauve::Converts<Old, Heap> bad{state, [](const Old&, Heap&) noexcept {}};")

    def test_a_port_in_a_core(self):
        self.refused_in_a_core("a read port is a member of a shell", 'mauve::ReadPort<double> bad{*this, "bad"};')
        self.refused_in_a_core("a write port is a member of a shell", 'mauve::WritePort<double> bad{*this, "bad"};')
        self.refused_in_a_core("a call port is a member of a shell", 'mauve::CallPort<double()> bad{*this, "bad"};')
        self.refused_in_a_core("an event port is a member of a shell", 'mauve::EventPort<> bad{*this, "bad"};')

    def test_a_read_port_with_a_default_of_another_type(self):
        self.refused_in_a_shell("with a default of its type", 'mauve::ReadPort<Plain> bad{*this, "bad", 1};')

    def test_a_write_port_with_a_safe_value_of_another_type(self):
        for value in ("mauve::Safe{0}", "Plain{}"):
            self.refused_in_a_shell("with a safe value of its type",
                                    'mauve::WritePort<Plain> bad{*this, "bad", %s};' % value)

    def test_a_call_without_a_signature(self):
        self.refused_in_a_shell("a call port has a signature", 'mauve::CallPort<double> bad{*this, "bad"};')
        self.refused_in_an_interface("a call service has a signature",
                                     'mauve::CallService<double> bad{*this, "bad", &Tank::level};')

    def test_a_service_with_a_method_of_another_form(self):
        for service, method, sentence in (("ReadService<int>", "level", "with a method `T method()`"),
                                          ("WriteService<int>", "fill", "with `void method(const T&)`"),
                                          ("CallService<int()>", "level", "with `R method(P...)`"),
                                          ("EventService<int>", "fill", "with `void method(P...)`")):
            self.refused_in_an_interface(sentence, 'mauve::%s bad{*this, "bad", &Tank::%s};' % (service, method))

    def test_a_service_in_a_shell(self):
        self.refused_in_a_shell("a service is a member of an interface",
                                'mauve::ReadService<double> bad{*this, "bad", &Tank::level};')

    def test_a_resource_whose_classes_do_not_fit(self):
        members = ("struct Services : mauve::Interface<Tank> {};"
                   " struct Others : mauve::Interface<Good> {};")
        for classes, sentence in (
                ("Tank, mauve::EmptyShell, Services", "the first class of a resource is its shell"),
                ("mauve::EmptyShell, Plain, Services", "the second class of a resource is its core"),
                ("mauve::EmptyShell, Tank, Plain", "the third class of a resource is its interface"),
                ("mauve::EmptyShell, Tank, Others", "this interface calls cores of another class"),
                ("OtherShell, Tank, Services", "this core expects another shell")):
            self.refused(sentence, members, f'plugin.resource<{classes}>("bad");')

    def test_a_type_that_is_not_described(self):
        self.refused("a type of a plugin is described: it has a static `type_name` and `fields()`", "", "plugin.type<Plain>();")
        self.refused_description("a type of a plugin is described: it has a static `type_name` and `fields()`",
                                 'static constexpr auto fields() { return std::tuple{mauve::field("x", &Data::x)}; }')

    def test_a_description_whose_fields_are_no_members(self):
        for fields in ('mauve::field("x", &Data::x)', 'std::tuple{mauve::field("x", &robot::Other::x)}', "std::tuple{1}"):
            self.refused("fields() of a described type T returns `std::tuple{mauve::field(",
                         "struct Other { double x = 0; };\n}\nstruct Data { double x = 0; };\n"
                         "template <> struct mauve::Described<Data> {"
                         ' static constexpr std::string_view name = "data/1";'
                         " static constexpr auto fields() { return %s; } };\nnamespace robot {" % fields,
                         "plugin.type<Data>();")
            self.refused("fields() of a described type T returns `std::tuple{mauve::field(",
                         "struct Other { double x = 0; };\n}\nstruct Data { double x = 0;"
                         ' static constexpr std::string_view type_name = "data/1";'
                         " static constexpr auto fields() { return %s; } };\nnamespace robot {" % fields,
                         "plugin.type<Data>();")

    def test_a_member_without_a_field(self):
        described = ('static constexpr std::string_view type_name = "data/1";'
                     ' static constexpr auto fields() { return std::tuple{mauve::field("x", &Data::x)}; }')
        for members in ("double x = 0; double y = 0;", "double x = 0; std::vector<int> y;", "int x = 0; int y[3] = {};",
                        "double x = 0; int y : 3;", "std::array<double, 2> x{}; bool y = false;"):
            self.refused("fields() of a described type T has a field for each member of T",
                         "struct Data { %s %s };" % (members, described), "plugin.type<Data>();")

    def test_types_whose_members_all_have_fields_and_opaque_ones_compile(self):
        described = 'static constexpr std::string_view type_name = "%s/1"; static constexpr auto fields() { return std::tuple{%s}; }'
        field = 'mauve::field("%s", &%s::%s)'
        kinds = {"a": "bool", "b": "float", "c": "mauve::Duration", "d": "mauve::Text<8>", "e": "std::array<double, 3>",
                 "f": "mauve::Bounded<int, 4>", "g": "Part", "h": "std::array<Part, 2>"}
        structs = "struct Part { double x = 0; int y = 0; %s };" % (
            described % ("part", ", ".join(field % (name, "Part", name) for name in "xy")))
        structs += "struct Data { %s %s };" % (
            " ".join(f"{kind} {name}{{}};" for name, kind in kinds.items()),
            described % ("data", ", ".join(field % (name, "Data", name) for name in kinds)))
        structs += "struct Opaque { std::vector<int> x; double y = 0; %s };" % (described % ("opaque", ""))
        structs += "struct Derived : Plain { int z = 0; %s };" % (
            described % ("derived", ", ".join(field % (name, "Derived", name) for name in "xz")))
        code, _, output = compile_text(
            HEADER % (structs, "plugin.type<Data>(); plugin.type<Derived>(); (void)mauve::data_type<Opaque>();"))
        self.assertEqual(code, 0, output)

    def test_a_field_whose_type_has_no_json(self):
        refusals = {"an enumeration is no field: declare the member as std::int32_t": ["Mode", "std::array<Mode, 2>"],
                    "a character is no field: declare a text as mauve::Text<N>": [
                        "char", "wchar_t", "char8_t", "std::array<char, 16>", "mauve::Bounded<char, 16>",
                        "std::array<std::array<char, 8>, 2>"],
                    "a long double is no field: declare the member as double": [
                        "long double", "std::array<long double, 2>"]}
        for sentence, kinds in refusals.items():
            for kind in kinds:
                self.refused(sentence,
                             "enum class Mode { stand, drive }; struct Data { double x = 0; %s odd{};"
                             ' static constexpr std::string_view type_name = "data/1";'
                             ' static constexpr auto fields() { return std::tuple{mauve::field("x", &Data::x),'
                             ' mauve::field("odd", &Data::odd)}; } };' % kind, "plugin.type<Data>();")

    def test_a_description_with_a_conversion_that_may_throw(self):
        self.refused_description(
            "`static void convert(const Old& old, T& now) noexcept`",
            'static constexpr std::string_view name = "data/1";'
            ' static constexpr auto fields() { return std::tuple{mauve::field("x", &Data::x)}; }'
            " using Before = robot::Plain; static void convert(const robot::Plain&, Data&) {}")
        self.refused("`static void convert(const Old& old, T& now) noexcept`",
                     'struct Data { double x = 0; static constexpr std::string_view type_name = "data/1";'
                     ' static constexpr auto fields() { return std::tuple{mauve::field("x", &Data::x)}; }'
                     " using Before = Plain; static void convert(const Plain&, Data&) {} };",
                     "plugin.type<Data>();")

    def test_a_method_with_the_name_of_a_hook_and_another_signature(self):
        for method in ("void on_cleanup() const {}", "bool on_configure(int) { return true; }",
                       "protected: void on_cleanup() const {} public:"):
            for kind, body in (("mauve::Core<Shell>", 'plugin.core<Bad>("bad");'),
                               ("mauve::Shell", 'plugin.component<Bad, mauve::PeriodicFsm<Own>>("bad");'),
                               ("mauve::Fsm<Good>", 'plugin.fsm<Bad>("bad");'),
                               ("mauve::Interface<Tank>",
                                'plugin.resource<mauve::EmptyShell, Tank, Bad>("bad");')):
                self.refused("the runtime calls `mauve::Status on_configure()`, `void on_cleanup()` and, of a core, "
                             "`void on_stop()` in this form only",
                             "struct Bad : %s { %s }; struct Own : mauve::Core<Bad> { void update() {} };"
                             % (kind, method) if kind == "mauve::Shell" else
                             "struct Bad : %s { %s };" % (kind, method), body)

    def test_a_core_whose_method_has_the_name_of_the_stop_hook_and_another_signature(self):
        self.refused("of a core, `void on_stop()` in this form only",
                     "struct Bad : mauve::Core<Shell> { void on_stop(int) {} };", 'plugin.core<Bad>("bad");')

    def test_a_core_that_uses_a_state_which_it_does_not_declare(self):
        self.refused("use of undeclared identifier 'state'" if "clang" in COMPILER else
                     "‘state’ was not declared in this scope",
                     "struct Bad : mauve::Core<Shell> { void update() { state->x = 1; } };", 'plugin.core<Bad>("bad");')

    def test_every_name_of_a_base_class_that_is_not_reserved_is_free_for_a_method(self):
        """Virtual functions have reserved names, so that nobody overrides one by accident."""
        page = (pathlib.Path(__file__).parents[2] / "docs/reference.md").read_text(encoding="utf-8")
        table = page.split("## Names with a meaning")[1].split("## ")[0]
        reserved = {name for row in re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
                    for name in re.findall(r"`(\w+)`", row) if name != "mauve_"}
        bases = {"detail/configurable.h": ["Configurable"], "core.h": ["CoreBase", "Core"], "shell.h": ["Shell"],
                 "interface.h": ["InterfaceBase", "Interface"], "fsm.h": ["FsmBase"]}
        names, virtual = set(), set()
        for header, classes in bases.items():
            text = re.sub(r"//.*", "", (pathlib.Path(HEADERS) / "mauve" / header).read_text(encoding="utf-8"))
            for base in classes:
                body = re.search(r"\nclass %s [^;{]*{(.*?)\n};" % base, text, re.DOTALL)[1]
                names |= set(re.findall(r"(\w+)\([^()]*(?:\([^()]*\)[^()]*)?\)(?: const)?(?: override)?\s*[{;]", body))
                virtual |= set(re.findall(r"virtual [^;{]*?(?<!~)\b(\w+)\(", body))
        self.assertEqual({name for name in virtual - reserved if not name.startswith("mauve_")}, set())
        self.assertIn("on_configure", virtual)
        free = sorted(name for name in names - reserved
                      if not name.startswith("mauve_") and not name[0].isupper() and name != "if")
        self.assertIn("configure", free)
        methods = " ".join(f"int {name}() {{ return 0; }}" for name in free)
        members = ("struct Outside : mauve::Shell { %s };"
                   " struct Own : mauve::Core<Outside> { void update() {} %s };"
                   " struct Machine : mauve::Fsm<Own> { Exec run{*this, \"run\", &Own::update}; %s"
                   " mauve::Status on_configure() override { start_at(run); return mauve::ok(); } };"
                   " struct Services : mauve::Interface<Own> { %s };" % ((methods,) * 4))
        code, _, output = compile_text(HEADER % (members, 'plugin.component<Outside, Own, Machine>("own");'
                                                 ' plugin.resource<Outside, Own, Services>("own_resource");'))
        self.assertEqual(code, 0, output)

    def test_an_older_standard(self):
        code, errors, output = compile_text(HEADER % ("", ""), "-std=c++17")
        self.assertNotEqual(code, 0)
        self.assertIn("mauve needs C++20: compile with -std=c++20", errors[0], output)


if __name__ == "__main__":
    unittest.main()
