// SPDX-License-Identifier: LGPL-3.0-or-later
// The differences of elements that join, leave and are replaced; any edits of a file.
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arch/compare/describe.h"
#include "arch/compare/diff.h"
#include "arch/text/value_json.h"
#include "mauve/host/resource.h"
#include "unit/arch/diff_fixture.h"

namespace mauve::arch {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::string_view kMore = R"("start": false },
    "third": { "type": "sample/control", "properties": { "core.gain": 1 },
               "ports": { "pose": { "connect": "more.read", "max_age": "5ms" },
                          "scan": "scan.read" } })";

TEST_F(Diff, LetsWhatIsNewJoinUnconnected) {
  std::string text = sample::with("\"start\": false }", kMore);
  text = sample::with("\"pose\":  {",
                      "\"more\":  { \"type\": \"sample/relay\", \"ports\": { "
                      "\"next\": \"pose.write\" } },\n    \"pose\":  {",
                      text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines), ElementsAre("+ resource more: \"sample/relay\"",
                                                  "+ component third: \"sample/control\""));
  EXPECT_TRUE(difference.change.edits.empty());
  EXPECT_TRUE(difference.change.remove.empty());
  ASSERT_EQ(difference.change.new_resources.size(), 1U);
  const NewResource& more = difference.change.new_resources[0];
  EXPECT_EQ(more.resource->name(), "more");
  EXPECT_EQ(more.resource->bindings().at(0), nullptr);
  EXPECT_THAT(said(more.connect), ElementsAre("next=pose.write/0"));
  ASSERT_EQ(difference.change.new_components.size(), 1U);
  const NewComponent& third = difference.change.new_components[0];
  for (const auto& binding : *third.component->bundle()->bindings) EXPECT_EQ(binding, nullptr);
  EXPECT_THAT(said(third.connect), ElementsAre("pose=more.read/5000000", "scan=scan.read/0"));
  EXPECT_EQ(third.component->core().find_property("gain")->value(), Value(1.0));
  EXPECT_EQ(wanted_->find_component("third"), nullptr) << "it was moved out";
  EXPECT_FALSE(third.component->configured());
}

TEST_F(Diff, LeavesNothingOfTheFileConnected) {
  const Difference difference = to_with("\"core.gain\": 0.5", "\"core.gain\": 0.75");

  std::size_t of_components = 0;
  std::size_t of_resources = 0;
  for (const ComponentBase* component : wanted_->components()) {
    of_components += component->bundle()->bindings->size();
    for (const auto& binding : *component->bundle()->bindings) EXPECT_EQ(binding, nullptr);
  }
  for (const ResourceBase* resource : wanted_->resources()) {
    of_resources += resource->bindings().size();
    for (const auto& binding : resource->bindings()) EXPECT_EQ(binding, nullptr);
  }
  EXPECT_GT(of_components, 0U);
  EXPECT_GT(of_resources, 0U);
}

TEST_F(Diff, RemovesWhatTheFileDoesNotNameAndDisconnectsItsUsers) {
  std::string text = sample::with("\"scan\": \"scan.read\", ", "");
  const auto begin = text.find("    \"scan\":  {");
  text.erase(begin, text.find('\n', begin) - begin);
  text = text.substr(0, text.find(",\n    \"right\"")) + "}}";

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines), ElementsAre("- resource scan: \"ring_buffer scan/1\"",
                                                  "- port left.ports.scan: \"scan.read\"",
                                                  "- component right: \"sample/bare\""));
  EXPECT_THAT(difference.change.remove, ElementsAre("scan", "right"));
  EXPECT_THAT(only_edit(difference).disconnect, ElementsAre("scan"));
}

TEST_F(Diff, LetsAComponentOfAnotherTypeLeaveAndJoinAgain) {
  const Difference difference = to_with("\"sample/bare\"", "\"sample/control\"");

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ component right: \"sample/bare\" -> \"sample/control\""));
  EXPECT_THAT(difference.change.remove, ElementsAre("right"));
  ASSERT_EQ(difference.change.new_components.size(), 1U);
  EXPECT_EQ(difference.change.new_components[0].component->type().name, "sample/control");
  EXPECT_TRUE(difference.change.edits.empty());
}

TEST_F(Diff, ListsTheValuesThatAComponentOfAnotherTypeGetsUnderItsName) {
  const std::string other = sample::with(
      "\"type\": \"sample/control\",",
      "\"type\": \"sample/bare\", \"core\": \"sample/attract\", \"fsm\": \"sample/periodic\",");

  const Difference difference =
      to(sample::with("\"core.gain\": 0.5", "\"core.gain\": 0.75", other));

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ component left: \"sample/control\" -> \"sample/bare\"",
                          "~ property left.core.gain: 0.5 -> 0.75"));
}

TEST_F(Diff, ConnectsEveryPortOfAReplacedResourceAnew) {
  std::string text = sample::with("\"type\": \"shared_data\", \"data\": \"pose/1\"",
                                  "\"type\": \"ring_buffer\", \"data\": \"pose/1\"");

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines), ElementsAre("~ resource pose: \"shared_data pose/1\" -> "
                                                  "\"ring_buffer pose/1\""));
  EXPECT_THAT(difference.change.remove, ElementsAre("pose"));
  ASSERT_EQ(difference.change.new_resources.size(), 1U);
  ASSERT_EQ(difference.change.edits.size(), 2U);
  const Edit& relay = difference.change.edits[0];
  EXPECT_EQ(relay.member, "relay");
  EXPECT_THAT(relay.disconnect, ElementsAre("next"));
  EXPECT_THAT(said(relay.connect), ElementsAre("next=pose.write/0"));
  const Edit& left = difference.change.edits[1];
  EXPECT_THAT(left.disconnect, ElementsAre("pose"));
  EXPECT_THAT(said(left.connect), ElementsAre("pose=pose.read/50000000"));
  EXPECT_THAT(difference.exchanged, ElementsAre("pose")) << "its users stay";
  EXPECT_EQ(difference.change.sync, Sync::cut) << "how is the caller's choice";
}

/// Replaces the ring buffer of scans, to which no port is connected.
class ResourceThatNobodyUses : public Diff {
 protected:
  Difference to_data(const std::string& data) {
    const std::string text = sample::with("\"scan\": \"scan.read\", ", "");
    running_ = made(text);
    wanted_ =
        made(sample::with("\"ring_buffer\", \"data\": \"scan/1\", \"properties\": { "
                          "\"core.capacity\": 16 }",
                          "\"shared_data\", \"data\": \"" + data + "\"", text));
    return running_ == nullptr || wanted_ == nullptr ? Difference{} : compare(*running_, *wanted_);
  }
};

TEST_F(ResourceThatNobodyUses, ExchangesItsContractForTheSakeOfItsValues) {
  const Difference difference = to_data("scan/1");

  EXPECT_THAT(difference.change.remove, ElementsAre("scan"));
  EXPECT_THAT(difference.exchanged, ElementsAre("scan"));
}

TEST_F(ResourceThatNobodyUses, ExchangesNoContractWhenItsValuesDoNotFit) {
  const Difference difference = to_data("pose/1");

  EXPECT_THAT(difference.change.remove, ElementsAre("scan"));
  EXPECT_THAT(difference.exchanged, IsEmpty());
}

TEST_F(Diff, ReplacesAResourceWhoseInterfaceHasAnotherProperty) {
  const Difference difference =
      to_with("\"interface.strict\": true", "\"interface.strict\": false");

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ property relay.interface.strict: true -> false"));
  EXPECT_THAT(difference.change.remove, ElementsAre("relay"));
  ASSERT_EQ(difference.change.new_resources.size(), 1U);
  EXPECT_THAT(said(difference.change.new_resources[0].connect), ElementsAre("next=pose.write/0"));
  EXPECT_THAT(only_edit(difference).disconnect, ElementsAre("command", "predict", "reset"));
}

TEST_F(Diff, LetsANameGoFromAResourceToAComponent) {
  std::string text = sample::with("\"relay\": { \"type\": \"sample/relay\"",
                                  "\"right\": { \"type\": \"sample/relay\"");
  text = sample::with("\"right\": { \"type\": \"sample/bare\"",
                      "\"relay\": { \"type\": \"sample/bare\"", text);
  for (const char* service : {"write", "predict", "reset"}) {
    text = sample::with("\"relay." + std::string(service), "\"right." + std::string(service), text);
  }

  const Difference difference = to(text);

  EXPECT_THAT(difference.change.remove, ElementsAre("relay", "right"));
  EXPECT_EQ(difference.change.new_resources.at(0).resource->name(), "right");
  EXPECT_EQ(difference.change.new_components.at(0).component->name(), "relay");
}

/// One edit of the sample and the line that it must give.
struct EditAndLine {
  std::string what, by, line;
};

const EditAndLine kEdits[] = {
    {"\"core.gain\": 0.5", "\"core.gain\": 0.25", "~ property left.core.gain: 0.5 -> 0.25"},
    {"\"x\": 1,", "\"x\": 3,",
     "~ property left.core.home: {\"x\":1,\"y\":2.5} -> {\"x\":3,\"y\":2.5}"},
    {"\"25ms\"", "\"5ms\"", "~ property left.fsm.period: \"25ms\" -> \"5ms\""},
    {"/dev/left", "/dev/l", "~ property left.shell.device: \"/dev/left\" -> \"/dev/l\""},
    {"\"core.capacity\": 16", "\"core.capacity\": 4", "~ property scan.core.capacity: 16 -> 4"},
    {"\"priority\": 60", "\"priority\": 61", "~ task left.task.priority: 60 -> 61"},
    {"\"offset\": \"1ms\"", "\"offset\": \"3ms\"", "~ task left.task.offset: \"1ms\" -> \"3ms\""},
    {"\"overrun_limit\": 3", "\"overrun_limit\": 4", "~ task left.task.overrun_limit: 3 -> 4"},
    {"\"sample/repel\"", "\"sample/attract\"",
     "~ core right.core: \"sample/repel\" -> \"sample/attract\""},
    {"\"scan\": \"scan.read\", ", "", "- port left.ports.scan: \"scan.read\""},
    {", \"reset\": \"relay.reset\"", "", "- port left.ports.reset: \"relay.reset\""},
    {"\"next\": \"pose.write\"", "", "- port relay.ports.next: \"pose.write\""},
    {"\"start\": false", "\"start\": true", "~ start right.start: false -> true"},
};

TEST_F(Diff, OfAnyEditsHasTheirLinesAndNoOthers) {
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    std::string text(sample::kArchitecture);
    std::vector<std::string> expected;
    for (const EditAndLine& one : kEdits) {
      if (random() % 3 != 0) continue;
      text = sample::with(one.what, one.by, text);
      expected.push_back(one.line);
    }
    EXPECT_THAT(said(to(text).lines), testing::UnorderedElementsAreArray(expected)) << text;
  }
}

TEST_F(Diff, IsEmptyWhenWhatRunsIsReadAgain) {
  std::mt19937 random(12);
  for (int round = 0; round < 100; ++round) {
    std::string text(sample::kArchitecture);
    for (const EditAndLine& one : kEdits) {
      if (random() % 2 == 0) text = sample::with(one.what, one.by, text);
    }
    running_ = made(text);
    ASSERT_NE(running_, nullptr);
    wanted_ = made(to_json_text(describe(*running_, catalog_)));
    ASSERT_NE(wanted_, nullptr);

    const Difference difference = compare(*running_, *wanted_);

    EXPECT_THAT(said(difference.lines), IsEmpty()) << text;
    EXPECT_TRUE(empty(difference.change));
  }
}

}  // namespace
}  // namespace mauve::arch
