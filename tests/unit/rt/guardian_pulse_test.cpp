// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/guardian_pulse.h"

#include <gtest/gtest.h>

namespace mauve::rt {
namespace {

using Sign = GuardianPulse::Sign;

/// One who asks, and looks when it should unless a test says otherwise.
class AskingLink {
 public:
  /// After the next pause, made longer by `late`.
  Sign look(Duration late = {}) {
    now_ += (pulse_.pause() + late).count();
    return pulse_.look(now_);
  }
  /// Until something is to be done; at most as often as a standstill may need.
  Sign next_sign(Duration late = {}) {
    for (int looks = 0; looks < 1'000; ++looks) {
      if (const Sign sign = look(late); sign != Sign::none) return sign;
    }
    return Sign::none;
  }
  void heard() { pulse_.heard(); }
  [[nodiscard]] Duration passed() const { return Duration{now_ - kBegin}; }

 private:
  static constexpr Instant kBegin = 1'000'000'000;
  Instant now_ = kBegin;
  GuardianPulse pulse_{kBegin};
};

TEST(GuardianPulse, AsksAgainAndAgainWhoeverAnswers) {
  AskingLink link;
  for (int question = 1; question <= 100; ++question) {
    ASSERT_EQ(link.next_sign(), Sign::ask);
    EXPECT_EQ(link.passed(), question * GuardianPulse::kBetweenQuestions);
    link.heard();
  }
}

TEST(GuardianPulse, TakesAStandstillForDeafnessWithinItsPatienceAndOnePause) {
  AskingLink link;
  ASSERT_EQ(link.next_sign(), Sign::ask);
  link.heard();  // and stands still from now on
  const Duration still = link.passed();

  ASSERT_EQ(link.next_sign(), Sign::ask);
  ASSERT_EQ(link.next_sign(), Sign::deaf);

  const Duration noticed = link.passed() - still;
  EXPECT_GE(noticed, GuardianPulse::kPatience);
  EXPECT_LE(noticed, GuardianPulse::kBetweenQuestions + GuardianPulse::kPatience +
                         GuardianPulse::kBetweenLooks);
}

TEST(GuardianPulse, HearsTheLastMomentOfItsPatience) {
  AskingLink link;
  ASSERT_EQ(link.next_sign(), Sign::ask);
  const auto looks = GuardianPulse::kPatience / GuardianPulse::kBetweenLooks - 1;
  for (int i = 0; i < looks; ++i) ASSERT_EQ(link.look(), Sign::none);
  link.heard();

  EXPECT_EQ(link.next_sign(), Sign::ask) << "the next question, and no deafness";
}

TEST(GuardianPulse, BlamesNobodyForAPauseOfTheWholeMachine) {
  AskingLink link;
  ASSERT_EQ(link.next_sign(), Sign::ask);

  EXPECT_EQ(link.look(Duration{1h}), Sign::none);
  link.heard();  // the answer was there all the time

  EXPECT_EQ(link.next_sign(), Sign::ask);
}

TEST(GuardianPulse, NoticesDeafnessAlsoWhenItIsAlwaysLateItself) {
  AskingLink link;
  ASSERT_EQ(link.next_sign(Duration{1s}), Sign::ask);

  EXPECT_EQ(link.next_sign(Duration{1s}), Sign::deaf);
}

}  // namespace
}  // namespace mauve::rt
