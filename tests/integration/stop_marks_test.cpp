// SPDX-License-Identifier: LGPL-3.0-or-later
// The value of a generation that a stop made.
#include "kept_daemon.h"

namespace mauve::test {
namespace {

/// A stop proves nothing about what runs on.
TEST_F(Generations, OfAStopAreWorthWhatWasStopped) {
  TrialDaemon daemon(kTrial, options());
  const auto in_the_file = exported(daemon);
  const Json second = {{"components", {"second"}}};
  ASSERT_EQ(daemon.ask("component.stop", second)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed") << "it has just been started";

  crash(daemon);
  daemon.start();
  EXPECT_EQ(daemon.component("second")["state"], "stopped") << daemon.errors();
  ASSERT_EQ(daemon.ask("component.start", second)["saved"], true);
  EXPECT_EQ(exported(daemon), in_the_file);

  ASSERT_EQ(daemon.ask("component.stop", second)["state"], "applied");
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "and with it what it came from";
  const auto stopped = exported(daemon);
  ASSERT_EQ(daemon.ask("component.start", second)["saved"], true);
  EXPECT_EQ(newest(daemon)["mark"], "confirmed") << "so is a start of what is confirmed";
  ASSERT_EQ(daemon.ask("component.stop", second)["state"], "applied");
  ASSERT_TRUE(eventually([&] {
    const auto last = newest(daemon);
    return last["command"] == "component.stop" && last["mark"] == "confirmed";
  }));

  crash(daemon);
  daemon.start();
  EXPECT_EQ(exported(daemon), stopped);
}

TEST_F(Generations, OfAStopAreConfirmedWhenNothingFailed) {
  TrialDaemon daemon(kTrial, options());
  const auto stopped = daemon.ask("component.stop", {{"components", {"second"}}});
  ASSERT_TRUE(is_stop(stopped)) << stopped;

  EXPECT_TRUE(eventually(
      [&] {
        const auto last = newest(daemon);
        return last["command"] == "component.stop" && last["mark"] == "confirmed";
      },
      std::chrono::seconds(60)));
}

/// `first` hangs in its first job; no guard ends it.
std::string hanging() {
  auto architecture = Json::parse(unguarded());
  architecture["components"]["first"]["core"] = "trial/hanging";
  return architecture.dump();
}

TEST_F(Generations, OfAStopOfAComponentThatHangsStartNothingAfterACrash) {
  TrialDaemon daemon(hanging(), options());
  ASSERT_TRUE(daemon.becomes("signal.read", 9.0)) << "it hangs";
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  const auto partly = daemon.ask("component.stop", {{"all", true}});
  ASSERT_EQ(partly["data"]["state"], "safe") << partly;
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(newest(daemon)["mark"], "confirmed");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("first")["state"], "stopped") << daemon.errors();
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
}

TEST_F(Generations, OfAStopOfAComponentThatHangsAreConfirmedWithTheStartBeforeIt) {
  TrialDaemon daemon(hanging(), options());
  ASSERT_TRUE(daemon.becomes("signal.read", 9.0)) << "it hangs";
  ASSERT_EQ(daemon.ask("component.stop", {{"all", true}})["data"]["state"], "safe");

  EXPECT_TRUE(eventually(
      [&] {
        const auto last = newest(daemon);
        return last["command"] == "component.stop" && last["mark"] == "confirmed";
      },
      std::chrono::seconds(60)));
}

/// `first` writes a safe value that `second` reads, so they stop one after the other.
TEST_F(Generations, OfAStopOfAllAreConfirmedAtOnceAndStartNothingAfterACrash) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  const Json all = {{"all", true}};
  const auto stopped = daemon.ask("component.stop", all);
  ASSERT_EQ(stopped["state"], "applied") << stopped;
  EXPECT_EQ(stopped["generation"], 3) << "each stage makes one";
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(newest(daemon)["generation"], 3);
  EXPECT_EQ(newest(daemon)["mark"], "confirmed");
  EXPECT_EQ(daemon.ask("config.history")["items"].size(), 2U) << "and the last one is saved";

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("first")["state"], "stopped") << daemon.errors();
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started again";
  ASSERT_EQ(daemon.ask("component.start", all)["saved"], true);
  EXPECT_EQ(newest(daemon)["mark"], "confirmed") << "so is a start of what is confirmed";
}

TEST_F(Generations, OfAStopOfAllSoonAfterAStartAreConfirmedWithIt) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("component.stop", {{"all", true}})["state"], "applied");
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed") << "it has just been started";

  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("first")["state"], "stopped") << daemon.errors();
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
}

/// Nothing confirms a start in which a component failed, unless a person does.
TEST_F(Generations, OfAStopAfterAFailedStartAreConfirmedByHand) {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["components"]["second"]["core"] = "trial/throwing_job";
  TrialDaemon daemon(architecture.dump(), options());
  ASSERT_TRUE(eventually([&] { return daemon.component("second")["state"] == "faulted"; }));
  const auto looked = daemon.ask("status.get")["uptime_s"].get<double>() + 0.2;
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["uptime_s"] > looked; }));
  ASSERT_EQ(daemon.ask("component.stop", {{"all", true}})["state"], "applied");
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");

  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  EXPECT_EQ(newest(daemon)["mark"], "confirmed");
  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("first")["state"], "stopped") << daemon.errors();
}

/// The generation of the stop has the mark of the one before it. When the probation ends, both
/// get the same mark.
TEST_F(Generations, OfAStopOfAllDuringAProbationAreConfirmedWithIt) {
  TrialDaemon daemon(kTrial, options());
  const Json set_on_probation = {{"values", {{"first.core.gain", 3.0}}},
                                 {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", set_on_probation)["saved"], true);
  ASSERT_EQ(daemon.ask("component.stop", {{"all", true}})["state"], "applied");
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");

  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("first")["state"], "stopped") << daemon.errors();
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
}

}  // namespace
}  // namespace mauve::test
