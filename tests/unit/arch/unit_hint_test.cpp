// SPDX-License-Identifier: LGPL-3.0-or-later
// The hint where a number with a unit was expected.
#include "arch/parse/unit_hint.h"

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include <mauve/plugin.h>

namespace mauve::arch::test {
namespace {

struct Timed : Core<EmptyShell> {
  Property<double> timeout{*this, "timeout", 0.5, "then stop", {.unit = "s", .max = 1.0}};
  Property<std::int32_t> wait{*this, "wait", 20, "then try again", {.unit = "ms"}};
  Property<double> range{*this, "range", 2.5, "seen", {.unit = "m"}};
};

std::string hint_for(const PropertyBase& property, const char* text) {
  const Value value{std::string(text)};
  const Status refused = property.accepts(value);
  return refused ? "taken" : with_unit(property, value, refused.error()).hint;
}

TEST(UnitHint, IsTheNumberThatADurationMeansInTheUnit) {
  const Timed core;

  EXPECT_EQ(hint_for(core.timeout, "50ms"), "a number in s: 0.05");
  EXPECT_EQ(hint_for(core.timeout, "1s"), "a number in s: 1");
  EXPECT_EQ(hint_for(core.wait, "1.5s"), "a number in ms: 1500");
}

TEST(UnitHint, IsTheValueNowForAnotherTextUnitOrRange) {
  const Timed core;

  EXPECT_EQ(hint_for(core.timeout, "soon"), "a number in s, such as 0.5, its value now");
  EXPECT_EQ(hint_for(core.timeout, "2s"), "a number in s, such as 0.5, its value now");
  EXPECT_EQ(hint_for(core.wait, "1us"), "a number in ms, such as 20, its value now");
  EXPECT_EQ(hint_for(core.range, "50ms"), "a number in m, such as 2.5, its value now");
}

}  // namespace
}  // namespace mauve::arch::test
