// SPDX-License-Identifier: LGPL-3.0-or-later
// The time is that of the observer: no test waits.
#include "rt/process/pulse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mauve::rt {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

/// After so many looks, each a second after the one before.
std::vector<std::string> silent_after(int looks) {
  std::vector<std::string> names;
  for (int i = 0; i < looks; ++i) {
    names.clear();
    for (const auto& one : Pulse::look(seconds(1))) names.push_back(one.name);
  }
  return names;
}

TEST(Pulse, NamesAThreadThatHasNotTurnedWithinTheBound) {
  Pulse turns("turns");
  Pulse stands("stands");
  turns.turn();
  stands.turn();
  EXPECT_THAT(silent_after(6), IsEmpty()) << "the first look sees the turn, five are the bound";
  turns.turn();
  EXPECT_THAT(silent_after(1), ElementsAre("stands"));
  stands.turn();
  EXPECT_THAT(silent_after(1), IsEmpty());
}

TEST(Pulse, LetsWorkWithABoundOfItsOwnTakeLong) {
  Pulse pulse("works");
  pulse.turn(seconds(8));
  EXPECT_THAT(silent_after(9), IsEmpty());
  EXPECT_THAT(silent_after(1), ElementsAre("works"));
  pulse.turn(Pulse::kBoundedElsewhere);
  EXPECT_THAT(silent_after(10'000), IsEmpty());
  pulse.turn();
  EXPECT_THAT(silent_after(6), IsEmpty()) << "the bound begins with the turn";
  EXPECT_THAT(silent_after(1), ElementsAre("works"));
}

TEST(Pulse, BlamesNoThreadForTimeInWhichTheWholeProcessStood) {
  Pulse pulse("stood");
  pulse.turn();
  EXPECT_THAT(Pulse::look(seconds(1)), IsEmpty());
  EXPECT_THAT(Pulse::look(hours(1)), IsEmpty());
  EXPECT_THAT(Pulse::look(hours(1)), IsEmpty());
}

TEST(Pulse, EndsWithItsThread) {
  {
    Pulse pulse("ended");
    EXPECT_THAT(silent_after(6), ElementsAre("ended"));
  }
  EXPECT_THAT(silent_after(6), IsEmpty());
}

}  // namespace
}  // namespace mauve::rt
