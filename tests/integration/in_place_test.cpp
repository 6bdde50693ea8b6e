// SPDX-License-Identifier: LGPL-3.0-or-later
// Cores exchanged while their component is parked.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST(SwapInPlace, ExchangesTheCoresOfAParkedComponent) {
  TrialDaemon daemon;

  const auto receipt = daemon.ask(
      "core.swap", {{"component", "first"}, {"core", "trial/other"}, {"in_place", true}});

  EXPECT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_EQ(daemon.component("first")["core"], "trial/other");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(SwapInPlace, RefusesACoreInQuarantine) {
  TrialDaemon daemon;
  Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));

  swap["in_place"] = true;
  const auto refused = daemon.ask("core.swap", swap);

  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("is in quarantine"));
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
}

TEST(SwapInPlace, RefusesWhatItCannotTryOut) {
  TrialDaemon daemon;
  const Json swap = {{"component", "first"}, {"core", "trial/other"}, {"in_place", true}};
  auto params = swap;
  params["misses"] = "2/64";
  const auto refused = daemon.ask("core.swap", params);
  EXPECT_EQ(refused["data"]["where"], "misses") << refused;
  EXPECT_EQ(refused["data"]["state"], "unchanged");
  EXPECT_EQ(refused["data"]["hint"], "leave out --misses, or --in-place");
  auto off = swap;
  off["probation"] = "off";
  EXPECT_FALSE(daemon.ask("core.swap", off).contains("probation"));
}

TEST(SwapInPlace, GoesBackToTheOldCoreWhenTheNewOneRefuses) {
  TrialDaemon daemon;

  const auto error = daemon.ask(
      "core.swap", {{"component", "first"}, {"core", "trial/refusing"}, {"in_place", true}});

  EXPECT_EQ(error["data"]["name"], "invalid_value") << error;
  EXPECT_EQ(error["data"]["state"], "rolled_back");
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

}  // namespace
}  // namespace mauve::test
