// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/say.h"

#include <utility>

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

Json with_missed(int missed) {
  return {
      {"components", {{{"name", "arm"}, {"missed", 0}}, {{"name", "base"}, {"missed", missed}}}}};
}

TEST(SayMissed, SaysThatOrdinaryThreadsMissReleasesWithoutAChangeToo) {
  Json ordinary = with_missed(43);
  say_missed(false, ordinary);
  EXPECT_EQ(ordinary["ordinary_threads"], true) << ordinary;
}

TEST(SayMissed, IsSilentWhereNothingWasMissedOrThreadsAreRealTime) {
  for (const auto& [realtime, missed] : {std::pair{false, 0}, {true, 43}}) {
    Json result = with_missed(missed);
    say_missed(realtime, result);
    EXPECT_FALSE(result.contains("ordinary_threads")) << result;
  }
}

}  // namespace
}  // namespace mauve::daemon
