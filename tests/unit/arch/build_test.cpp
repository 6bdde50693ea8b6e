// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/build.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arch/build/load.h"
#include "arch/parse/parts.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "unit/arch/architecture_text.h"
#include "unit/arch/sample_plugin.h"

namespace mauve::arch {
namespace {

using sample::with;

class Build : public testing::Test {
 protected:
  Build() { EXPECT_TRUE(catalog_.add(sample::make_plugin())); }

  std::unique_ptr<Architecture> accepted(std::string_view text) {
    Problems problems;
    auto architecture = load(text, catalog_, problems);
    for (const Problem& problem : problems.sorted()) ADD_FAILURE() << to_string(problem, "text");
    return architecture;
  }
  std::vector<Problem> refused(std::string_view text) {
    Problems problems;
    EXPECT_EQ(load(text, catalog_, problems), nullptr);
    return problems.sorted();
  }
  Problem only_problem(std::string_view text) {
    const auto problems = refused(text);
    for (std::size_t i = 1; i < problems.size(); ++i) ADD_FAILURE() << to_string(problems[i], "");
    return problems.empty() ? Problem{} : problems[0];
  }

  plugin::Catalog catalog_;
};

TEST_F(Build, MakesAllElementsInTheOrderOfTheFile) {
  const auto architecture = accepted(sample::kArchitecture);

  ASSERT_NE(architecture, nullptr);
  EXPECT_EQ(architecture->name(), "sample");
  ASSERT_EQ(architecture->resources().size(), 3U);
  EXPECT_EQ(architecture->resources()[0]->name(), "pose");
  EXPECT_EQ(architecture->resources()[1]->type().name, "ring_buffer");
  ASSERT_EQ(architecture->components().size(), 2U);
  EXPECT_EQ(architecture->components()[1]->name(), "right");
  EXPECT_FALSE(architecture->configured());
}

TEST_F(Build, ReportsAPortThatDoesNotExistBesideItsResourceThatIsRefused) {
  const auto problems = refused(
      with("\"pose\": { \"connect\"", "\"pos\": { \"connect\"", with("\"pose/1\"", "\"pose/2\"")));

  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[1].error.id, "unknown_port");
  EXPECT_EQ(problems[1].error.hint, "did you mean left.ports.pose?");
}

TEST_F(Build, TakesTheCoreOfTheTypeOrTheOneOfTheFile) {
  const auto architecture = accepted(sample::kArchitecture);

  ASSERT_NE(architecture, nullptr);
  EXPECT_EQ(architecture->find_component("left")->bundle()->core_type.name, "sample/attract");
  EXPECT_EQ(architecture->find_component("right")->bundle()->core_type.name, "sample/repel");
  EXPECT_EQ(architecture->find_component("right")->bundle()->fsm_type.name, "sample/periodic");
}

TEST_F(Build, SetsPropertiesOfEveryPart) {
  const auto architecture = accepted(sample::kArchitecture);

  ASSERT_NE(architecture, nullptr);
  const Parts left = parts_of(*architecture->find_component("left"));
  EXPECT_EQ(find_property(left, "core.gain")->value(), Value(0.5));
  EXPECT_EQ(find_property(left, "fsm.period")->value(), Value("25ms"));
  EXPECT_EQ(find_property(left, "shell.device")->value(), Value("/dev/left"));
  EXPECT_EQ(*find_property(left, "core.home")->value().find("y"), Value(2.5));
  const Parts relay = parts_of(*architecture->find_resource("relay"));
  EXPECT_EQ(find_property(relay, "interface.strict")->value(), Value(true));
  const Parts scan = parts_of(*architecture->find_resource("scan"));
  EXPECT_EQ(find_property(scan, "core.capacity")->value(), Value(16));
}

TEST_F(Build, ConnectsPortsOfComponentsAndResources) {
  const auto architecture = accepted(sample::kArchitecture);

  ASSERT_NE(architecture, nullptr);
  const ComponentBase& left = *architecture->find_component("left");
  const auto& bindings = *left.bundle()->bindings;
  const auto& pose = bindings.at(left.shell().find_port("pose")->index());
  EXPECT_EQ(pose->service().address(), "pose.read");
  EXPECT_EQ(pose->max_age(), Duration{50'000'000});
  EXPECT_EQ(bindings.at(left.shell().find_port("reset")->index())->service().address(),
            "relay.reset");
  const ResourceBase& relay = *architecture->find_resource("relay");
  EXPECT_EQ(relay.bindings().at(0)->service().address(), "pose.write");
}

TEST_F(Build, SetsTaskAttributes) {
  const auto architecture = accepted(sample::kArchitecture);

  ASSERT_NE(architecture, nullptr);
  const TaskAttributes& left = architecture->find_component("left")->task();
  EXPECT_EQ(left.priority, 60);
  EXPECT_EQ(left.cpus, std::vector<int>{0});
  EXPECT_EQ(left.offset, Duration{1'000'000});
  EXPECT_EQ(left.deadline, Duration{8'000'000});
  EXPECT_EQ(left.budget, Duration{2'000'000});
  EXPECT_EQ(left.stack, 131072U);
  EXPECT_EQ(left.on_overrun, OnOverrun::stop);
  EXPECT_EQ(left.overrun_limit, 3U);
  TaskAttributes parked;
  parked.start = false;
  EXPECT_EQ(architecture->find_component("right")->task(), parked);
}

TEST_F(Build, MakesAnArchitectureThatCanBeConfigured) {
  const auto architecture = accepted(sample::kArchitecture);

  ASSERT_NE(architecture, nullptr);
  const Status done = architecture->configure();
  EXPECT_TRUE(done) << to_string(done.error());
}

struct Wrong {
  std::string what, by, at, message, hint;
  Errc code;
  std::uint32_t line;
};

const Wrong kWrongs[] = {
    {"\"sample/control\"", "\"sample/contrl\"", "left.type", "contrl", "sample/control",
     Errc::unknown_name, 12},
    {"\"sample/control\"", "\"simple/control\"", "left.type", "plugin \"simple\" is not loaded",
     "did you mean \"sample/control\"?", Errc::unknown_name, 12},
    {"\"sample/control\"", "\"drivers/control\"", "left.type", "plugin \"drivers\" is not loaded",
     "add \"drivers\" to \"plugins\"", Errc::unknown_name, 12},
    {"\"sample/repel\"", "\"sample/repell\"", "right.core", "repell", "sample/repel",
     Errc::unknown_name, 21},
    {"\"sample/repel\"", "\"sample/throwing\"", "right.core", "constructor threw: out of order", "",
     Errc::hook_threw, 21},
    {"\"sample/repel\"", "\"sample/stranger\"", "right.core", "calls sample/control/1",
     "cores that fit: sample/attract, sample/repel, sample/throwing", Errc::type_mismatch, 21},
    {"\"core\": \"sample/repel\", ", "", "right.core",
     "\"core\" is missing: components of type sample/bare need one",
     "cores that fit: sample/attract", Errc::invalid_value, 21},
    {"\"sample/periodic\"", "\"sample/periodc\"", "right.fsm", "periodc", "sample/periodic",
     Errc::unknown_name, 21},
    {"\"sample/relay\"", "\"sample/rely\"", "relay.type", "rely", "sample/relay",
     Errc::unknown_name, 8},
    {"\"shared_data\"", "\"shared_dat\"", "pose.type", "shared_dat", "shared_data",
     Errc::unknown_name, 6},
    {"\"pose/1\"", "\"poze/1\"", "pose.data", "poze/1", "pose/1", Errc::unknown_name, 6},
    {", \"data\": \"pose/1\"", "", "pose.data",
     "\"data\" is missing: shared_data needs a data type", "\"velocity/1\"", Errc::invalid_value,
     6},
    {"\"sample/relay\",", "\"sample/relay\", \"data\": \"pose/1\",", "relay.data",
     "has no meaning here", "only shared_data and ring_buffer", Errc::invalid_value, 8},
    {"\"core.gain\"", "\"core.gian\"", "left.core.gian", "left has no property of this name",
     "did you mean \"core.gain\"?", Errc::unknown_name, 13},
    {"\"core.gain\": 0.5", "\"core.gain\": \"0.5\"", "left.core.gain", "expected a number", "",
     Errc::invalid_value, 13},
    {"\"core.gain\": 0.5", "\"core.gain\": 2.5", "left.core.gain", "2.5 is above the maximum 2", "",
     Errc::invalid_value, 13},
    {"\"25ms\"", "\"25\"", "left.fsm.period", "\"25\" has no unit", "10ms", Errc::invalid_value,
     13},
    {"\"y\": 2.5", "\"z\": 2.5", "left.core.home.z", "no field of pose/1",
     "pose/1 has the fields x, y", Errc::unknown_name, 14},
    {"\"core.capacity\": 16", "\"core.capacity\": 0", "scan.core.capacity",
     "0 is below the minimum 1", "", Errc::invalid_value, 7},
    {"\"predict\":", "\"predicts\":", "left.ports.predicts", "left has no port of this name",
     "left.ports.predict", Errc::unknown_name, 17},
    {"\"scan.read\"", "\"scann.read\"", "left.ports.scan", "there is no resource scann", "scan",
     Errc::unknown_name, 16},
    {"\"scan.read\"", "\"scan.reed\"", "left.ports.scan", "has no service of this name",
     "scan.read", Errc::unknown_name, 16},
    {"\"scan.read\"", "\"left.read\"", "left.ports.scan", "there is no resource left", "",
     Errc::unknown_name, 16},
    {"\"scan.read\"", "\"scan.write\"", "left.ports.scan",
     "is a read scan/1 port, but scan.write is a write scan/1 service", "", Errc::type_mismatch,
     16},
    {"\"scan.read\"", "\"pose.read\"", "left.ports.scan",
     "is a read scan/1 port, but pose.read is a read pose/1 service", "", Errc::type_mismatch, 16},
    {"\"relay.predict\"", "\"relay.reset\"", "left.ports.predict", "call double(double) port", "",
     Errc::type_mismatch, 17},
    {"\"relay.reset\"", "{ \"connect\": \"relay.reset\", \"max_age\": \"1s\" }", "left.ports.reset",
     "\"max_age\" has no meaning here: only read ports have it", "", Errc::invalid_value, 17},
    {"\"next\": \"pose.write\"", "\"next\": \"relay.write\"", "relay",
     "resources would wait for each other for ever: relay -> relay", "disconnect", Errc::cycle, 8},
};

TEST_F(Build, RefusesEachMistakeWithItsPlaceAddressAndHint) {
  for (const Wrong& wrong : kWrongs) {
    const Problem problem = only_problem(with(wrong.what, wrong.by));
    SCOPED_TRACE(wrong.by + " gave " + to_string(problem, "text"));
    EXPECT_EQ(problem.error.code, wrong.code);
    EXPECT_EQ(problem.error.at, wrong.at);
    EXPECT_NE(problem.error.message.find(wrong.message), std::string::npos);
    EXPECT_NE(problem.error.hint.find(wrong.hint), std::string::npos);
    EXPECT_EQ(problem.where.line, wrong.line);
  }
}

TEST_F(Build, ReportsMistakesOfFormAndOfMeaningTogether) {
  std::string text = with("\"core.gain\"", "\"core.gian\"");
  text = with("\"priority\": 60", "\"priority\": 600", text);
  text = with("\"scan.read\"", "\"scan.reed\"", text);
  text = with("sample/repel", "sample/repell", text);

  const auto problems = refused(text);

  ASSERT_EQ(problems.size(), 4U);
  EXPECT_EQ(problems[0].error.at, "left.core.gian");
  EXPECT_EQ(problems[1].error.at, "left.ports.scan");
  EXPECT_EQ(problems[2].error.at, "left.task.priority");
  EXPECT_EQ(problems[3].error.at, "right.core");
}

// "right" of the sample with properties, ports and a task, each of them with a mistake.
std::string with_mistakes_in_right(std::string_view head) {
  return with(
      R"("right": { "type": "sample/bare", "core": "sample/repel", "fsm": "sample/periodic",)",
      "\"right\": { " + std::string(head) + R"(
      "properties": { "core.distanse": 1, "shell.devise": "x", "fsm.period": "25" },
      "ports": { "poze": "pose.read", "scan": "scan.reed", "command": "relay.reset",
                 "pose": { "connect": "pose.read", "max_age": "1s" } },
      "task": { "priority": 600 },)");
}

std::vector<std::string> places_of(const std::vector<Problem>& problems) {
  std::vector<std::string> places;
  for (const Problem& problem : problems) places.push_back(problem.error.at);
  return places;
}

TEST_F(Build, ReportsEverythingElseOfAComponentWithoutAFittingCore) {
  const std::string fsm = R"("fsm": "sample/periodic", )";
  for (const std::string core : {R"("core": "sample/repell", )", R"("core": "sample/stranger", )",
                                 R"("core": "sample/throwing", )", ""}) {
    const auto problems =
        refused(with_mistakes_in_right(R"("type": "sample/bare", )" + core + fsm));
    const std::vector<std::string> expected = {
        "right.core",       "right.shell.devise",  "right.fsm.period",   "right.ports.poze",
        "right.ports.scan", "right.ports.command", "right.task.priority"};
    EXPECT_EQ(places_of(problems), expected) << core;
  }
}

TEST_F(Build, ReportsEverythingElseOfAComponentWithoutStateMachine) {
  const auto problems = refused(with_mistakes_in_right(
      R"("type": "sample/bare", "core": "sample/repel", "fsm": "sample/periodc", )"));
  EXPECT_EQ(places_of(problems),
            (std::vector<std::string>{"right.fsm", "right.core.distanse", "right.shell.devise",
                                      "right.ports.poze", "right.ports.scan", "right.ports.command",
                                      "right.task.priority"}));
}

TEST_F(Build, ReportsWhatDoesNotDependOnAnUnknownType) {
  const auto problems = refused(with_mistakes_in_right(
      R"("type": "sample/bear", "core": "sample/repel", "fsm": "sample/periodic", )"));
  EXPECT_EQ(places_of(problems),
            (std::vector<std::string>{"right.type", "right.core.distanse", "right.fsm.period",
                                      "right.ports.scan", "right.task.priority"}));
}

TEST_F(Build, RefusesEveryCpuThatThisMachineDoesNotHave) {
  const auto problems = refused(with("\"cpus\": [0]", "\"cpus\": [0, 1022, 1023]"));

  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].error.at, "left.task.cpus");
  EXPECT_EQ(problems[0].where.line, 18U);
  EXPECT_EQ(problems[0].error.message, "CPU 1022 is not one that this process may use");
  EXPECT_NE(problems[0].error.hint.find("usable CPUs, from "), std::string::npos);
  EXPECT_EQ(problems[1].error.message, "CPU 1023 is not one that this process may use");
}

TEST_F(Build, ReportsAKeyTwiceAndEverythingElse) {
  std::string text = with("\"right\":", "\"left\":");
  text =
      with("\"sample/repel\",", "\"sample/repel\", \"ports\": { \"poze\": \"pose.read\" },", text);
  text = with("\"reset\": \"relay.reset\"", "\"reset\": \"relay.reset\", \"reset\": \"relay.rest\"",
              text);
  text = with("\"command\": \"relay.write\"",
              "\"command\": \"relay.write\", \"command\": \"relay.write\"", text);
  text = with("\"cpus\": [0]", "\"cpus\": [0], \"cpus\": [0]", text);
  text = with("\"core.gain\": 0.5", "\"core.gain\": 0.5, \"core.gain\": 2.5", text);

  std::vector<std::string> reported;
  for (const Problem& problem : refused(text)) {
    reported.push_back(problem.error.at + ": " + problem.error.message);
  }
  EXPECT_EQ(reported,
            (std::vector<std::string>{
                ": the key \"core.gain\" appears twice",
                "left.core.gain: 2.5 is above the maximum 2 1/s",
                ": the key \"command\" appears twice",
                ": the key \"reset\" appears twice",
                "left.ports.reset: relay.rest: resource relay has no service of this name",
                ": the key \"cpus\" appears twice",
                ": the key \"left\" appears twice",
                "left.ports.poze: left has no port of this name",
            }));
}

TEST_F(Build, ReportsAMissingPluginOnceAndNotEveryNameOfIt) {
  plugin::Catalog empty;
  Problems problems;

  EXPECT_EQ(load(sample::kArchitecture, empty, problems), nullptr);

  const auto found = problems.sorted();
  ASSERT_EQ(found.size(), 1U) << to_string(found.back(), "");
  EXPECT_EQ(found[0].error.at, "plugins.sample");
  EXPECT_EQ(found[0].where.line, 4U);
}

TEST_F(Build, DoesNotReportConnectionsToAResourceThatIsRefused) {
  const Problem problem = only_problem(with("\"sample/relay\"", "\"sample/rely\""));
  EXPECT_EQ(problem.error.at, "relay.type");
}

// Any damage to a valid file gives an architecture or problems, each with a line; never both,
// never neither, never a crash.
TEST_F(Build, SurvivesRandomDamageAndAlwaysNamesALine) {
  const std::string_view pieces[] = {
      "{",    "}",      "[]",   "\"",      ":",           ",",           "null",         "1e9",
      "-1",   "\"x\"",  "true", "\"1ms\"", "scan",        "pose",        "relay",        "read",
      "core", "sample", "left", "reset",   "shared_data", "ring_buffer", "\"sample/x\"", "write"};
  std::mt19937 random(13);
  for (int round = 0; round < 3'000; ++round) {
    std::string text(sample::kArchitecture);
    for (auto change = random() % 3 + 1; change > 0; --change) {
      const std::size_t where = random() % text.size();
      const std::size_t length = std::min<std::size_t>(random() % 8, text.size() - where);
      text.replace(where, length, pieces[random() % std::size(pieces)]);
    }
    Problems problems;
    const auto architecture = load(text, catalog_, problems);
    ASSERT_NE(architecture == nullptr, problems.empty()) << text;
    for (const Problem& problem : problems.sorted()) {
      ASSERT_GT(problem.where.line, 0U) << to_string(problem, "text") << text;
    }
  }
}

// Words of the file exchanged for one another: mostly valid JSON with a wrong meaning.
TEST_F(Build, SurvivesExchangedWords) {
  const std::string_view words[] = {"scan", "pose", "relay", "left",   "right",   "read",  "write",
                                    "core", "fsm",  "shell", "sample", "control", "repel", "reset"};
  std::mt19937 random(17);
  for (int round = 0; round < 3'000; ++round) {
    std::string text(sample::kArchitecture);
    for (int change = 0; change < 2; ++change) {
      const std::string_view word = words[random() % std::size(words)];
      const std::size_t found = text.find(word, random() % text.size());
      if (found != std::string::npos) {
        text.replace(found, word.size(), words[random() % std::size(words)]);
      }
    }
    Problems problems;
    const auto architecture = load(text, catalog_, problems);
    ASSERT_NE(architecture == nullptr, problems.empty()) << text;
    for (const Problem& problem : problems.sorted()) {
      ASSERT_GT(problem.where.line, 0U) << to_string(problem, "text") << text;
      ASSERT_FALSE(problem.error.message.empty());
    }
  }
}

TEST(ReadFile, SaysWhatIsWrongWithTheFile) {
  EXPECT_EQ(read_file("no/such/file.json").error().code, Errc::unknown_name);
  EXPECT_EQ(read_file(MAUVE_SOURCE_DIR "/etc").error().message, "is not a regular file");
  EXPECT_EQ(read_file("/dev/zero").error().message, "is not a regular file");
  const auto text = read_file(MAUVE_SOURCE_DIR "/etc/architecture.schema.json");
  ASSERT_TRUE(text);
  EXPECT_FALSE(text->empty());
}

}  // namespace
}  // namespace mauve::arch
