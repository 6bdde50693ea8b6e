// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/failures.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exec/update/fault_record.h"

namespace mauve::daemon {
namespace {

using logging::Event;

constexpr std::int64_t kOneSecond = 1'000'000'000;

logging::Record record(const std::string& component, std::int64_t at, Event event,
                       const std::string& text) {
  auto made = logging::make_record(event, {{"component", component}, {"text", text}});
  made.monotonic_ns = at;
  return made;
}

Failure at(std::int64_t time, const std::string& text = "sensor lost") {
  Failure failure;
  failure.monotonic_ns = time;
  failure.text = text;
  return failure;
}

class FailuresTest : public testing::Test {
 protected:
  void talk(const std::string& component, int records, std::int64_t from) {
    for (int i = 0; i < records; ++i) {
      history.add(record(component, from + i, Event::core_message, std::to_string(i)));
    }
  }
  void add_fault(std::int64_t time) {
    auto fault = record("arm", time, Event::component_faulted, "threw: sensor lost, in state go");
    fault.fields = {{"cause", std::string("threw")}, {"state", std::string("go")}};
    history.add(fault);
  }

  logging::History history{64};
  Failures failures;
};

TEST(Causes, AreTheFailuresThatExplainKnows) {
  const std::vector<std::string_view> explained{
#define MAUVE_ERROR(name, meaning, advice)
#define MAUVE_FAILURE(name, meaning, advice) #name,
#define MAUVE_VALUE_STATUS(name, meaning, advice)
#include "protocol/errors.def"
#undef MAUVE_VALUE_STATUS
#undef MAUVE_FAILURE
#undef MAUVE_ERROR
  };
  EXPECT_THAT(explained, testing::ElementsAreArray(exec::kCauseWords));
}

TEST(Causes, AreFoundByTheirText) {
  for (const auto word : exec::kCauseWords) {
    const auto place = std::ranges::find(exec::kCauseWords, word);
    const auto cause = static_cast<exec::Cause>(place - exec::kCauseWords.begin());
    EXPECT_EQ(exec::word_of(cause), word);
    EXPECT_EQ(exec::cause_of(to_string(cause)), cause);
  }
  EXPECT_EQ(exec::cause_of("unknown"), std::nullopt);
}

/// The three that a trace records are written in one word everywhere, so `explain` finds each.
TEST(Causes, OfAJobHaveOneNameInTracesAndInTheLog) {
  for (const auto cause : {exec::Cause::threw, exec::Cause::crashed, exec::Cause::hung}) {
    EXPECT_EQ(to_string(cause), exec::word_of(cause));
  }
}

TEST_F(FailuresTest, KnowNothingOfWhoNeverFailed) {
  EXPECT_EQ(failures.find("arm", history), nullptr);
  EXPECT_EQ(failures.last_change("arm"), nullptr);
  EXPECT_EQ(failures.running("arm").core, "");
}

TEST_F(FailuresTest, KeepTheRecordsUpToTheFailure) {
  talk("arm", 30, kOneSecond);
  talk("leg", 5, kOneSecond);
  add_fault(2 * kOneSecond);
  talk("arm", 3, 2 * kOneSecond + 50);
  failures.note("arm", at(2 * kOneSecond));

  const auto* failure = failures.find("arm", history);

  ASSERT_NE(failure, nullptr);
  ASSERT_EQ(failure->records.size(), Failures::kRecords);
  EXPECT_EQ(failure->records.back().event, Event::component_faulted) << "nothing of afterwards";
  EXPECT_EQ(failure->records.front().text, "11") << "the newest before it, of nobody else";
}

TEST_F(FailuresTest, DoNotTakeTheWordsOfAFailureJustBefore) {
  add_fault(2 * kOneSecond);
  auto failure = at(3 * kOneSecond);
  failure.cause = "overran too often";

  failures.note("arm", failure);

  EXPECT_EQ(failures.find("arm", history)->cause, "overran too often");
  EXPECT_EQ(failures.find("arm", history)->monotonic_ns, 3 * kOneSecond);
  EXPECT_EQ(failures.find("arm", history)->fsm_state, "");
}

TEST_F(FailuresTest, AreRememberedWhenTheLogHasRolledOver) {
  talk("arm", 3, kOneSecond);
  add_fault(2 * kOneSecond);
  failures.note("arm", at(2 * kOneSecond));
  failures.ask_log(history, 2 * kOneSecond);
  failures.ask_log(history, 3 * kOneSecond);

  talk("arm", 500, 4 * kOneSecond);

  const auto* failure = failures.find("arm", history);
  ASSERT_EQ(failure->records.size(), 4U);
  EXPECT_EQ(failure->records.back().event, Event::component_faulted);
}

TEST_F(FailuresTest, CountAndKeepTheLastOne) {
  failures.changed({"arm", "leg"}, {42, "then", "core.swap", 7, "try it"});
  failures.note("arm", at(kOneSecond, "first"));
  failures.note("arm", at(2 * kOneSecond, "second"));

  const auto* failure = failures.find("arm", history);

  EXPECT_EQ(failure->text, "second");
  EXPECT_EQ(failure->times, 2U);
  ASSERT_TRUE(failure->change.has_value());
  EXPECT_EQ(failure->change->generation, 42U);
  EXPECT_EQ(failures.find("leg", history), nullptr);
}

TEST_F(FailuresTest, CountAFailureOnceWhateverIsDoneAboutIt) {
  failures.note("arm", at(kOneSecond));
  auto restarted = at(kOneSecond);
  restarted.reaction = Reaction::restarted;
  failures.note("arm", restarted);

  EXPECT_EQ(failures.find("arm", history)->times, 1U);
  EXPECT_EQ(failures.find("arm", history)->reaction, Reaction::restarted);
  EXPECT_TRUE(failures.knows("arm", kOneSecond, Reaction::parked));
  EXPECT_FALSE(failures.knows("arm", kOneSecond + 1, Reaction::parked))
      << "it was started, and failed again";
}

TEST_F(FailuresTest, WhoseReactionIsNotOverAreKnownUntilItEnds) {
  auto recovers = at(kOneSecond);
  recovers.reaction = Reaction::recovers;
  failures.note("arm", recovers);

  EXPECT_TRUE(failures.knows("arm", kOneSecond, Reaction::recovers));
  EXPECT_FALSE(failures.knows("arm", kOneSecond, Reaction::parked)) << "it recovers no more";

  failures.note("arm", at(kOneSecond));

  EXPECT_TRUE(failures.knows("arm", kOneSecond, Reaction::recovers));
  EXPECT_TRUE(failures.knows("arm", kOneSecond, Reaction::parked));
  EXPECT_EQ(failures.find("arm", history)->times, 1U);
}

TEST_F(FailuresTest, AreForgottenWhenTheComponentLeaves) {
  failures.note("arm", at(kOneSecond));
  failures.note("leg", at(kOneSecond));

  failures.keep_only({"leg"});

  EXPECT_EQ(failures.find("arm", history), nullptr);
  EXPECT_NE(failures.find("leg", history), nullptr);
}

}  // namespace
}  // namespace mauve::daemon
