// SPDX-License-Identifier: LGPL-3.0-or-later
// Rules, transactions and permissions: from the file, against an architecture, into a change, and
// back into a file.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arch/build/load.h"
#include "arch/compare/describe.h"
#include "arch/parse/part_of_value.h"
#include "arch/parse/quantity.h"
#include "arch/parse/target.h"
#include "arch/parse/transaction.h"
#include "arch/text/value_json.h"
#include "mauve/host/architecture.h"
#include "mauve/host/deployer.h"
#include "plugin/load/catalog.h"
#include "unit/arch/architecture_text.h"
#include "unit/arch/sample_plugin.h"

namespace mauve::arch {
namespace {

constexpr const char* kSupervision = R"(
  "transactions": {
    "blind": [ { "disconnect": "left.ports.scan" },
               { "connect": "left.ports.pose", "to": "relay.read", "max_age": "20ms" } ],
    "calm":  [ { "swap": "left", "core": "sample/repel", "state": "drop" },
               { "set": "left.core.distance", "value": 0.5 } ],
    "slow":  [ { "set": "left.core.gain", "value": 0.25 }, { "stop": "right" } ]
  },
  "rules": [
    { "name": "lost", "when": "left.missed > 3", "do": "blind" },
    { "name": "cautious", "when": "left.ports.pose.status == stale and not relay.interface.strict",
      "for": "2s", "until": "pose.read.x < 1.5",
      "when_unknown": "fire", "max_age": "5s", "do": [ { "start": "right" } ],
      "cool_down": "10s", "per_hour": 6 }
  ],)";

/// The sample architecture with supervision.
std::string supervised(const std::string& text = kSupervision) {
  return sample::with("\"resources\": {", text + "\"resources\": {");
}

class RulesInFiles : public testing::Test {
 protected:
  RulesInFiles() { EXPECT_TRUE(catalog_.add(sample::make_plugin())); }

  std::unique_ptr<Architecture> accepted(const std::string& text) {
    Problems problems;
    auto architecture = load(text, catalog_, problems, &supervision_);
    for (const Problem& problem : problems.sorted()) ADD_FAILURE() << to_string(problem, "text");
    return architecture;
  }
  std::vector<Problem> refused(const std::string& text) {
    Problems problems;
    EXPECT_EQ(load(text, catalog_, problems), nullptr);
    return problems.sorted();
  }
  /// The fault of one rule or step, as a sentence.
  std::string refusal(const std::string& what, const std::string& by) {
    const auto problems = refused(sample::with(what, by, supervised()));
    EXPECT_EQ(problems.size(), 1U) << by;
    for (const Problem& problem : problems) EXPECT_GT(problem.where.line, 3U);
    return problems.empty() ? "" : to_string(problems[0].error);
  }
  std::string when(const std::string& condition) {
    return refusal("\"left.missed > 3\"", "\"" + condition + "\"");
  }
  std::string step(const std::string& text) { return refusal("{ \"stop\": \"right\" }", text); }

  Result<Change> change(const Deployer& deployer, const Architecture& architecture,
                        const std::string& transaction) {
    return change_of(*supervision_.find(transaction), architecture, deployer, catalog_);
  }

  plugin::Catalog catalog_;
  rules::Supervision supervision_;
};

/// Is this part of the text?
testing::AssertionResult has(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << '"' << text << "\" has no \"" << part << '"';
}

TEST_F(RulesInFiles, AreReadWithTheirTransactionsAndPermissions) {
  const auto architecture = accepted(
      sample::with("\"start\": false", "\"may_request\": [\"calm\", \"slow\"]", supervised()));

  ASSERT_NE(architecture, nullptr);
  ASSERT_EQ(supervision_.rules.size(), 2U);
  const rules::Rule& cautious = supervision_.rules[1];
  EXPECT_EQ(cautious.timing, (rules::Timing{2s, 10s, 6}));
  EXPECT_EQ(cautious.until->text(), "pose.read.x < 1.5");
  EXPECT_EQ(cautious.when_unknown, rules::Unknown::fire);
  EXPECT_EQ(cautious.max_age, 5s);
  EXPECT_EQ(supervision_.rules[0].max_age, 0s);
  EXPECT_EQ(cautious.steps.size(), 1U);
  EXPECT_EQ(supervision_.rules[0].transaction, "blind");
  EXPECT_EQ(supervision_.find("blind")->at(1).max_age, 20ms);
  EXPECT_TRUE(supervision_.find("calm")->at(0).fresh);
  EXPECT_TRUE(supervision_.permits("right", "calm"));
  EXPECT_FALSE(supervision_.permits("right", "blind"));
  EXPECT_FALSE(supervision_.permits("left", "calm"));
}

TEST_F(RulesInFiles, AreTheSameWhenWrittenAndReadAgain) {
  const auto first = accepted(
      sample::with("\"start\": false", "\"may_request\": [\"calm\", \"slow\"]", supervised()));
  ASSERT_NE(first, nullptr);
  const std::string text = to_json_text(describe(*first, catalog_, {}, supervision_));

  const auto second = accepted(text);

  ASSERT_NE(second, nullptr) << text;
  EXPECT_EQ(to_json_text(describe(*second, catalog_, {}, supervision_)), text);
  EXPECT_TRUE(has(text, "\"cool_down\": \"10s\""));
  EXPECT_TRUE(has(text, "\"max_age\": \"20ms\""));
  EXPECT_EQ(supervision_.rules.size(), 2U);
  EXPECT_TRUE(supervision_.permits("right", "slow"));
}

TEST_F(RulesInFiles, AreRefusedWhereAConditionNamesWhatIsNotThere) {
  EXPECT_TRUE(has(when("lleft.missed > 3"), "did you mean left"));
  EXPECT_TRUE(has(when("left.misssed > 3"), "did you mean missed"));
  EXPECT_TRUE(has(when("left.core.gian > 3"), "did you mean left.core.gain"));
  EXPECT_TRUE(has(when("left.ports.pos.status == stale"), "did you mean left.ports.pose"));
  EXPECT_TRUE(has(when("pose.read.height > 1"), "it has: x, y"));
  EXPECT_TRUE(has(when("left.missed > 3 and left.gone > 1"), "left.gone (at character 21)"));
  EXPECT_TRUE(has(when("left.missed >"), "rules.lost.when: expected a value"));
}

TEST_F(RulesInFiles, AreRefusedWhereAConditionComparesWhatCannotBeCompared) {
  EXPECT_TRUE(has(when("left.missed > 3ms"), "is a number, but is compared with a duration"));
  EXPECT_TRUE(has(when("left.fsm.period > 3"), "write a number and a unit"));
  EXPECT_TRUE(has(when("left.missed"), "compared with true or false"));
  EXPECT_TRUE(has(when("left.state == fauled"), "did you mean \"faulted\""));
  EXPECT_TRUE(has(when("left.ports.pose.status == old"), "is never \"old\""));
  EXPECT_TRUE(has(when("pose.read > 1"), "name a field of it: x, y"));
  EXPECT_TRUE(has(when("left.core.home > 1"), "name a field of it: x, y"));
  EXPECT_TRUE(has(when("left.ports.command > 1"), "is a write port"));
  EXPECT_TRUE(has(when("relay.read.x > 1"), "made for each reader"));
  EXPECT_TRUE(has(when("left.ports.scan.status == stale"), "made for each reader")) << "a queue";
}

TEST_F(RulesInFiles, AreRefusedWhereAStepIsImpossible) {
  EXPECT_TRUE(has(step(R"({ "stop": "rihgt" })"), "did you mean right"));
  EXPECT_TRUE(has(step(R"({ "stop": "relay" })"), "is a resource, not a component"));
  EXPECT_TRUE(has(step(R"({ "halt": "right" })"), "says nothing to do"));
  EXPECT_TRUE(has(step(R"({ "stop": "right", "start": "right" })"), "a step does one thing"));
  EXPECT_TRUE(has(step(R"({ "stop": "right", "reset": true })"), "unknown key \"reset\""));
  EXPECT_TRUE(has(step(R"("right")"), "expected an object"));
  EXPECT_TRUE(has(step(R"({ "disconnect": "left.ports.scna" })"), "did you mean left.ports.scan"));
  EXPECT_TRUE(has(step(R"({ "disconnect": "left.scan" })"), "is not the address of a port"));
  EXPECT_TRUE(has(step(R"({ "connect": "left.ports.pose", "to": "scan.read" })"), "is a read"));
  EXPECT_TRUE(has(step(R"({ "connect": "left.ports.pose", "to": "pose.raed" })"), "pose.read"));
  EXPECT_TRUE(has(step(R"({ "connect": "left.ports.pose" })"), "\"to\" is missing"));
  EXPECT_TRUE(has(step(R"({ "connect": "left.ports.command", "to": "pose.write",
                            "max_age": "1s" })"),
                  "max_age"));
  EXPECT_TRUE(has(step(R"({ "swap": "left", "core": "sample/repell" })"), "sample/repel"));
  EXPECT_TRUE(has(step(R"({ "swap": "left", "core": "sample/stranger" })"), "contract"));
  EXPECT_TRUE(
      has(step(R"({ "swap": "left", "core": "sample/attract", "state": "keep" })"), "drop"));
  EXPECT_TRUE(has(step(R"({ "set": "left.core.steps", "value": "many" })"), "expected an integer"));
  EXPECT_TRUE(has(step(R"({ "set": "left.core.step", "value": 3 })"), "left.core.steps"));
  EXPECT_TRUE(has(step(R"({ "set": "left.core.steps" })"), "\"value\" is missing"));
  EXPECT_TRUE(has(step(R"({ "set": "relay.interface.strict", "value": true })"), "core"));
  EXPECT_TRUE(has(step(R"({ "set": "left.core.gain", "value": 0.5 })"), "another one changes"));
}

TEST_F(RulesInFiles, KnowThePropertiesOfTheCoreThatTheirOwnSwapBrings) {
  EXPECT_TRUE(
      has(refusal("\"left.core.distance\"", "\"left.core.distanc\""), "did you mean distance"));
  EXPECT_TRUE(has(refusal("\"left.core.distance\"", "\"left.core.gain\""),
                  "the new core has no property of this name"));
}

TEST_F(RulesInFiles, NameTransactionsThatAreThere) {
  EXPECT_TRUE(has(refusal("\"do\": \"blind\"", "\"do\": \"bilnd\""), "did you mean \"blind\""));
  EXPECT_TRUE(has(refusal("\"do\": \"blind\"", "\"do\": []"), "has no step"));
  EXPECT_TRUE(has(refusal("\"start\": false", "\"may_request\": [\"clam\"]"), "\"calm\""));
  EXPECT_TRUE(has(refusal("\"start\": false", "\"may_request\": [\"calm\", \"calm\"]"), "twice"));
  EXPECT_TRUE(has(refusal("\"cautious\"", "\"lost\""), "a rule has this name already"));
  EXPECT_TRUE(has(refusal("\"name\": \"lost\", ", ""), "\"name\" is missing"));
  EXPECT_TRUE(has(refusal("\"fire\"", "\"fires\""), "fire"));
  EXPECT_TRUE(has(refusal("\"per_hour\": 6", "\"per_hour\": 0"), "is not from 1 to 3600"));
  EXPECT_TRUE(has(refusal("\"cool_down\"", "\"cooldown\""), "did you mean \"cool_down\""));
}

TEST_F(RulesInFiles, ReportAllMistakesAtOnceInTheOrderOfTheFile) {
  std::string text = supervised();
  text = sample::with("\"left.missed > 3\"", "\"left.misssed >\"", text);
  text = sample::with("{ \"stop\": \"right\" }", "{ \"stop\": \"rigth\" }", text);
  text = sample::with("pose.read.x < 1.5", "pose.read.height < 1.5", text);
  text = sample::with("\"start\": false", "\"may_request\": [\"clam\"]", text);
  text = sample::with("\"sample/relay\"", "\"sample/rely\"", text);

  const auto problems = refused(text);

  ASSERT_EQ(problems.size(), 5U) << "and nothing about what would use the relay";
  EXPECT_EQ(problems[0].error.at, "transactions.slow");
  EXPECT_EQ(problems[1].error.at, "rules.lost.when");
  EXPECT_EQ(problems[2].error.at, "rules.cautious.until");
  EXPECT_EQ(problems[3].error.at, "relay.type");
  EXPECT_EQ(problems[4].error.at, "right.may_request");
}

TEST_F(RulesInFiles, BecomeOneEditAComponentAndLeaveOutWhatIsSo) {
  const auto architecture = accepted(supervised());
  ASSERT_NE(architecture, nullptr);
  Deployer deployer(*architecture, {Realtime::off, true});
  ASSERT_TRUE(deployer.deploy());

  const auto slow = change(deployer, *architecture, "slow");
  ASSERT_TRUE(slow);
  ASSERT_EQ(slow->edits.size(), 1U) << "right is parked already";
  EXPECT_EQ(slow->edits[0].member, "left");

  const auto blind = change(deployer, *architecture, "blind");
  ASSERT_TRUE(blind);
  ASSERT_EQ(blind->edits.size(), 1U);
  EXPECT_EQ(blind->edits[0].disconnect, (std::vector<std::string>{"scan", "pose"}))
      << "what is connected elsewhere is disconnected first";
  EXPECT_EQ(blind->edits[0].connect.size(), 1U);
  const auto applied = deployer.apply(*blind);
  ASSERT_TRUE(applied) << to_string(applied.error());
  EXPECT_TRUE(change(deployer, *architecture, "blind")->edits.empty());

  const auto calm = change(deployer, *architecture, "calm");
  ASSERT_TRUE(calm);
  ASSERT_TRUE(deployer.apply(*calm));
  EXPECT_EQ(deployer.status("left").core, "sample/repel");
  EXPECT_EQ(change(deployer, *architecture, "calm")->edits.size(), 1U) << "fresh means fresh";
}

TEST_F(RulesInFiles, FindAPlainValueBehindEveryKindOfAddress) {
  const auto architecture = accepted(supervised());
  ASSERT_NE(architecture, nullptr);
  const auto kind = [&](const char* address) {
    const auto quantity = find_quantity(*architecture, address);
    EXPECT_TRUE(quantity) << address << (quantity ? "" : to_string(quantity.error()));
    return quantity ? std::string(rules::to_string(quantity->kind)) : std::string();
  };

  EXPECT_EQ(kind("left.state"), "a word");
  EXPECT_EQ(kind("left.late"), "a duration");
  EXPECT_EQ(kind("left.core.gain"), "a number");
  EXPECT_EQ(kind("left.fsm.period"), "a duration");
  EXPECT_EQ(kind("left.shell.device"), "a word");
  EXPECT_EQ(kind("left.core.home.x"), "a number");
  EXPECT_EQ(kind("relay.interface.strict"), "true or false");
  EXPECT_EQ(kind("pose.read.x"), "a number");
  EXPECT_EQ(kind("pose.read.age"), "a duration");
  EXPECT_EQ(kind("left.ports.pose.status"), "a word");
  EXPECT_EQ(kind("left.ports.pose.y"), "a number");
}

TEST_F(RulesInFiles, NameTheWholeValueToARequestForAPartOfIt) {
  const auto architecture = accepted(supervised());
  ASSERT_NE(architecture, nullptr);
  const Error other = refuse({Errc::unknown_name, "unknown_address"}, "x", "other");
  const auto set = [&](const char* address) {
    const Error error = part_not_set(*architecture, address, "3", other);
    return error.id + ": " + error.hint;
  };
  const auto get = [&](const char* address) {
    const Error error = part_not_read(*architecture, address, other);
    return error.id + ": " + error.hint;
  };

  EXPECT_EQ(set("left.core.home.x"),
            "field_not_alone: mauvectl set left.core.home='{\"x\":3}'; it keeps the other fields");
  EXPECT_EQ(set("pose.read.x"),
            "field_not_alone: mauvectl write pose.write '{...}' takes a whole value");
  EXPECT_EQ(set("left.ports.pose.x"), "field_not_alone: mauvectl show left lists the properties");
  EXPECT_EQ(set("left.core.home.depth"), "unknown_field: it has: x, y");
  EXPECT_EQ(set("left.core.hme"), "unknown_address: ");
  EXPECT_EQ(set("left.state"), "unknown_address: ");
  EXPECT_EQ(get("scan.read.ranges"), "part_without_address: mauvectl get scan.read");
  EXPECT_EQ(get("pose.read.depth"), "unknown_field: it has: x, y");
  EXPECT_EQ(get("pose.reed.x"), "unknown_address: ");
  const auto message = [&](const char* address) {
    return find_target(*architecture, address).error().message;
  };
  EXPECT_EQ(message("left.core.hme"),
            "core " + architecture->find_component("left")->bundle()->core_type.name +
                ", which is in force, has no value of this name");
  EXPECT_EQ(message("left.fsm.hme"), "there is nothing of this name");
}

}  // namespace
}  // namespace mauve::arch
