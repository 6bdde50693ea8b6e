// SPDX-License-Identifier: LGPL-3.0-or-later
// `mauvectl protocol`, and answers that are printed as the rows of their methods describe them.
#include "protocol/methods.h"

#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/complete.h"
#include "protocol/row.h"
#include "render/words.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Protocol, ListsEveryMethodWithoutADaemon) {
  const auto outcome = run("/nowhere", {"protocol"});

  EXPECT_EQ(outcome.exit, 0);
  const auto lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), protocol::methods().size() + 1);
  EXPECT_TRUE(lines.front().starts_with("METHOD")) << lines.front();
  for (const auto& method : protocol::methods()) {
    const auto line = std::ranges::find_if(lines, [&](std::string_view one) {
      return one.starts_with(std::string(method.name) + " ");
    });
    ASSERT_NE(line, lines.end()) << method.name;
    EXPECT_THAT(std::string(*line), HasSubstr(std::string(method.help)));
    EXPECT_THAT(std::string(*line), HasSubstr(std::string(to_string(method.role))));
  }
}

TEST(Protocol, PrintsAnOpenRpcDocument) {
  const auto outcome = run("/nowhere", {"--json", "protocol"});
  const auto document = Json::parse(outcome.out, nullptr, false);

  ASSERT_TRUE(document.is_object());
  EXPECT_EQ(document["openrpc"], "1.2.6");
  EXPECT_EQ(document["methods"].size(), protocol::methods().size());
}

TEST(Protocol, DescribesOneMethodWithTheRecordsOfItsAnswer) {
  const auto outcome = run("/nowhere", {"protocol", "rules.list"});

  EXPECT_EQ(outcome.exit, 0);
  EXPECT_THAT(outcome.out, HasSubstr("PARAMETER  TYPE"));
  EXPECT_THAT(outcome.out, HasSubstr("rule       text, may be absent"));
  EXPECT_THAT(outcome.out, HasSubstr("list of Rule"));
  EXPECT_THAT(outcome.out, HasSubstr("Rule: One rule of the daemon."));
  EXPECT_THAT(outcome.out, HasSubstr("duration"));
}

TEST(Protocol, NamesTheNearestMethod) {
  const auto outcome = run("/nowhere", {"protocol", "core.swpa"});

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean 'core.swap'?"));
}

TEST(Protocol, CompletesTheNamesOfMethods) {
  std::set<std::string> words;
  for (const auto& one : complete({"protocol", ""}).candidates) words.insert(one.word);
  for (const auto& method : protocol::methods()) {
    EXPECT_TRUE(words.contains(std::string(method.name))) << method.name;
  }
}

namespace sample {

using namespace protocol::row;

constexpr protocol::Field kFields[] = {
    has("name", text, "The name"), has("late_ns", or_null(ns), "The lateness"),
    may("free_bytes", bytes, "The space"), has("cpus", list(count), "The CPUs")};
constexpr protocol::Record kThing{"Thing", "A thing", kFields};
constexpr protocol::Field kItems[] = {has("items", list(kThing), "All things")};
constexpr protocol::Field kMore[] = {has("items", list(kThing), "All things"),
                                     has("t_ns", ns, "The time"), may("gone", text, "Nothing"),
                                     may("uptime_s", seconds, "How long it runs")};

}  // namespace sample

TEST(RenderAnswer, MakesATableOfAListOfRecordsWithUnits) {
  const protocol::Method method{.name = "thing.list", .answer = sample::kItems};
  const Json answer = {
      {"items",
       {{{"name", "first"}, {"late_ns", 1200}, {"free_bytes", 2048}, {"cpus", {0, 1}}},
        {{"name", "second"}, {"late_ns", nullptr}, {"cpus", Json::array()}}}}};

  const auto shown = render_answer(method, answer, {});
  const auto lines = lines_of(shown);

  ASSERT_EQ(lines.size(), 3U) << shown;
  EXPECT_THAT(std::string(lines[0]), HasSubstr("FREE BYTES"));
  EXPECT_THAT(std::string(lines[0]), HasSubstr("LATE "));
  EXPECT_THAT(std::string(lines[1]), HasSubstr("1.2 us"));
  EXPECT_THAT(std::string(lines[1]), HasSubstr("0, 1"));
  EXPECT_TRUE(lines[2].ends_with(" -")) << lines[2];
  EXPECT_EQ(render_answer(method, {{"items", Json::array()}}, {}), "none\n");
}

TEST(RenderAnswer, PutsSingleValuesBeforeTables) {
  const protocol::Method method{.name = "thing.get", .answer = sample::kMore};

  const auto shown = render_answer(method, {{"items", Json::array()}, {"t_ns", 5'000'000'000}}, {});

  EXPECT_EQ(shown, "t: 5.0 s\nitems\nnone\n");
  EXPECT_THAT(render_answer(method, {{"uptime_s", 2}}, {}), HasSubstr("uptime: 2 s\n"));
  EXPECT_THAT(shown, Not(HasSubstr("gone")));
}

}  // namespace
}  // namespace mauve::ctl
