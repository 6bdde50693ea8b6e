// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests whose deadline passes, at each stage of their change.
#include "commands/deadlines.h"

#include <gtest/gtest.h>

#include "commands/answer.h"
#include "support/ramp.h"
#include "unit/daemon/front.h"

namespace mauve::daemon {
namespace {

class DeadlinesTest : public Front<ramp::One<ramp::Up>> {
 protected:
  CallPtr watched(Json params) {
    auto call = std::make_shared<Call>();
    call->method = protocol::find_method("core.swap");
    call->params = std::move(params);
    call->received = begin;
    call->reply = [this](server::Outcome outcome) { answers.push_back(std::move(outcome)); };
    deadlines.watch(call);
    return call;
  }
  void look_after(std::chrono::milliseconds time) { deadlines.look(running, begin + time); }
  [[nodiscard]] const Fault& refusal() const { return std::get<Fault>(answers.at(0)); }

  const Deadlines::Time begin = std::chrono::steady_clock::now();
  Deadlines deadlines;
  std::vector<server::Outcome> answers;
};

TEST_F(DeadlinesTest, OfAChangeThatWaitsAreKeptAndItIsRefused) {
  const auto call = watched({{"deadline_ms", 100}});
  look_after(std::chrono::milliseconds(100));
  EXPECT_TRUE(answers.empty());

  look_after(std::chrono::milliseconds(101));

  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(refusal().name, "timed_out");
  EXPECT_EQ(refusal().state, "unchanged");
  EXPECT_FALSE(advance_to(Stage::preparing, *call->stage)) << "it does not begin any more";
}

TEST_F(DeadlinesTest, OfAChangeThatIsBeingPreparedKeepItFromTakingEffect) {
  const auto call = watched({{"deadline_ms", 100}});
  ASSERT_TRUE(advance_to(Stage::preparing, *call->stage));

  look_after(std::chrono::milliseconds(101));

  EXPECT_EQ(refusal().state, "unchanged");
  EXPECT_FALSE(check_conditions(running, *call));
  EXPECT_EQ(call->stage->load(), Stage::expired);
}

TEST_F(DeadlinesTest, OfAChangeThatTakesEffectAreAnsweredAsUnknownOnce) {
  const auto call = watched({{"deadline_ms", 100}});
  ASSERT_TRUE(advance_to(Stage::under_way, *call->stage));

  look_after(std::chrono::milliseconds(101));
  look_after(std::chrono::milliseconds(200));
  call->reply(Json{{"state", "applied"}});

  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(refusal().name, "timed_out");
  EXPECT_EQ(refusal().state, "unknown");
}

TEST_F(DeadlinesTest, AreNotLookedAtAfterTheAnswer) {
  {
    const auto call = watched({{"deadline_ms", 100}});
    call->reply(Json{{"state", "applied"}});
  }
  look_after(std::chrono::milliseconds(101));

  EXPECT_EQ(answers.size(), 1U);
}

TEST_F(DeadlinesTest, ThatAreNotSaidNeverPass) {
  const auto call = watched(Json::object());
  look_after(std::chrono::hours(24));

  EXPECT_TRUE(answers.empty());
  EXPECT_TRUE(check_conditions(running, *call));
}

}  // namespace
}  // namespace mauve::daemon
