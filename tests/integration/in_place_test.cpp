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

/// A component whose core holds a file that only one core can hold at a time.
class OfADevice : public testing::Test {
 protected:
  static std::string alone() {
    auto architecture = Json::parse(kTrial);
    architecture["components"].erase("second");
    architecture["components"]["first"]["core"] = "trial/noting";
    architecture["components"]["first"]["properties"] = {
        {"fsm.period", "2ms"}, {"core.alone", true}, {"core.file", "device"}};
    return architecture.dump();
  }
  [[nodiscard]] bool runs_build(int number) { return daemon.becomes("first.core.number", number); }

  TrialDaemon daemon{alone()};
  const Json set_ = {{"values", {{"first.core.gain", 3.0}}}};
  const Json reload_ = {{"plugin", "trial"}};
};

TEST_F(OfADevice, SetsAPropertyOfACoreWhileItsComponentStands) {
  const auto beside = daemon.ask("param.set", set_);
  EXPECT_THAT(beside["message"].get<std::string>(), HasSubstr("is held by another core")) << beside;
  auto in_place = set_;
  in_place["in_place"] = true;

  const auto receipt = daemon.ask("param.set", in_place);

  EXPECT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
  EXPECT_EQ(daemon.component("first")["state"], "running");
  EXPECT_EQ(daemon.ask("change.undo")["state"], "applied") << "it is on probation";
  EXPECT_TRUE(daemon.becomes("first.core.gain", 1.0)) << daemon.errors();
}

TEST_F(OfADevice, ReloadsTheirPluginWhileTheComponentStands) {
  ASSERT_TRUE(runs_build(1)) << daemon.errors();
  daemon.install(2);
  const auto beside = daemon.ask("plugin.reload", reload_);
  EXPECT_THAT(beside["message"].get<std::string>(), HasSubstr("is held by another core")) << beside;
  auto in_place = reload_;
  in_place["in_place"] = true;

  const auto receipt = daemon.ask("plugin.reload", in_place);

  EXPECT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_TRUE(receipt.contains("probation")) << receipt;
  EXPECT_TRUE(runs_build(2)) << daemon.errors();
  ASSERT_EQ(daemon.ask("change.confirm")["changed"], true);
  EXPECT_TRUE(eventually([&] {
    return daemon.errors().find("plugin trial unloaded: replaced by a new one") !=
           std::string::npos;
  })) << daemon.errors();
}

TEST_F(OfADevice, HaveTheBuildBeforeAgainWhenAReloadInPlaceIsUndone) {
  ASSERT_TRUE(runs_build(1)) << daemon.errors();
  daemon.install(2);
  auto in_place = reload_;
  in_place["in_place"] = true;
  ASSERT_EQ(daemon.ask("plugin.reload", in_place)["state"], "applied");

  EXPECT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_TRUE(runs_build(1)) << daemon.errors();
  EXPECT_TRUE(eventually([&] {
    return daemon.errors().find("plugin trial unloaded: its reload was rolled back") !=
           std::string::npos;
  })) << daemon.errors();
  EXPECT_EQ(daemon.ask("plugin.reload", in_place)["state"], "applied") << "no former build is kept";
}

TEST_F(OfADevice, LeaveTheMemoryAtOnceWithoutAProbation) {
  daemon.install(2);
  auto in_place = reload_;
  in_place["in_place"] = true;
  in_place["probation"] = "off";

  EXPECT_EQ(daemon.ask("plugin.reload", in_place)["state"], "applied");

  EXPECT_TRUE(runs_build(2)) << daemon.errors();
  EXPECT_TRUE(eventually([&] {
    return daemon.errors().find("plugin trial unloaded: replaced by a new one") !=
           std::string::npos;
  })) << daemon.errors();
}

TEST(ChangeInPlace, IsRefusedUnlessItIsOfOneCore) {
  TrialDaemon daemon;
  const Json both = {{"values", {{"first.core.gain", 3.0}, {"second.core.gain", 3.0}}},
                     {"in_place", true}};
  const Json attribute = {{"values", {{"first.task.budget", "1ms"}}}, {"in_place", true}};

  for (const auto& params : {both, attribute}) {
    const auto refused = daemon.ask("param.set", params);
    EXPECT_EQ(refused["data"]["where"], "in_place") << refused;
    EXPECT_EQ(refused["data"]["state"], "unchanged");
  }
  const auto refused = daemon.ask("plugin.reload", {{"plugin", "trial"}, {"in_place", true}});
  EXPECT_EQ(refused["data"]["where"], "in_place") << "two components run its code: " << refused;
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
}

}  // namespace
}  // namespace mauve::test
