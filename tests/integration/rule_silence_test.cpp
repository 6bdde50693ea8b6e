// SPDX-License-Identifier: LGPL-3.0-or-later
// Rules that watch for a component that says nothing.
#include "rules_daemon.h"

namespace mauve::test {
namespace {

/// Nobody would tell that a device is silent while its driver stands.
TEST(Rules, DoNotKnowAWarningOfAComponentThatStandsWhereAnAgeIsAsked) {
  auto file = Json::parse(supervised(
      R"({ "name": "blind", "when": "first.core.dull == true", "max_age": "50ms",
           "when_unknown": "fire", "do": "rest" })"));
  file["components"]["first"]["core"] = "trial/requesting";
  RulesDaemon daemon(file.dump());
  const auto look = [&] { return daemon.rule("blind"); };
  ASSERT_TRUE(eventually([&] { return look()["state"] == "armed"; })) << look();
  EXPECT_EQ(look()["fired"], 0) << "it runs, and has nothing to warn of";

  daemon.ask("component.stop", {{"components", {"first"}}});

  EXPECT_TRUE(daemon.fired("blind", 1)) << look();
}

}  // namespace
}  // namespace mauve::test
