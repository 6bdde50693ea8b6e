// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/name.h"

#include <gtest/gtest.h>

namespace mauve {
namespace {

const std::vector<std::string> kKnown{"component", "components", "core", "plugins", "priority"};

TEST(NearestName, ForgivesAWrongLetter) { EXPECT_EQ(nearest_name("cora", kKnown), "core"); }

TEST(NearestName, ForgivesAMissingAndAnAddedLetter) {
  EXPECT_EQ(nearest_name("plugns", kKnown), "plugins");
  EXPECT_EQ(nearest_name("priorityy", kKnown), "priority");
}

TEST(NearestName, CountsTwoSwappedLettersAsOneEdit) {
  EXPECT_EQ(nearest_name("croe", kKnown), "core");
}

TEST(NearestName, PrefersTheCloserOfTwo) {
  EXPECT_EQ(nearest_name("componentz", {"component", "componentzz"}), "component");
  EXPECT_EQ(nearest_name("componnets", kKnown), "components");
}

TEST(NearestName, CompletesABeginning) { EXPECT_EQ(nearest_name("prio", kKnown), "priority"); }

TEST(NearestName, SaysNothingWhenNothingIsNear) {
  EXPECT_EQ(nearest_name("xyz", kKnown), "");
  EXPECT_EQ(nearest_name("", kKnown), "");
  EXPECT_EQ(nearest_name("core", {}), "");
}

TEST(NearestName, BecomesAHintInTheQuotesOfTheCaller) {
  EXPECT_EQ(did_you_mean("cora", kKnown), "did you mean core?");
  EXPECT_EQ(did_you_mean("cora", kKnown, "'"), "did you mean 'core'?");
  EXPECT_EQ(did_you_mean("xyz", kKnown, "'"), "");
  EXPECT_EQ(known_names("cora", kKnown), "did you mean core?");
  EXPECT_EQ(known_names("xyz", {"fsm", "core"}), "there are fsm, core");
  EXPECT_EQ(known_names("xyz", {"fsm"}), "there is fsm");
  EXPECT_EQ(known_names("xyz", {}), "");
}

TEST(NearestName, IsOneOfManyNamesOfWhichTheHintHasTwelve) {
  std::string twelve = "n1";
  std::vector<std::string> names{"n1"};
  for (int i = 2; i <= 15; ++i) {
    names.push_back("n" + std::to_string(i));
    if (i <= 12) twelve += ", " + names.back();
  }
  EXPECT_EQ(known_names("other", names), "there are " + twelve + " and 3 more");
}

TEST(NearestName, DoesNotWorkHardForHostileNames) {
  EXPECT_EQ(nearest_name(std::string(1 << 20, 'a'), {std::string(1 << 20, 'a')}), "");
}

}  // namespace
}  // namespace mauve
