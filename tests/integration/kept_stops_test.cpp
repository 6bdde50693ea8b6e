// SPDX-License-Identifier: LGPL-3.0-or-later
// The parts of the generation in force at a crash that hold without a confirmation: its stops, and
// the name of its architecture.
#include "kept_daemon.h"
#include "rt/thread/run_guarded.h"

namespace mauve::test {
namespace {

const Json kSecond = {{"components", {"second"}}};

void stop_second(TrialDaemon& daemon) {
  EXPECT_TRUE(is_stop(daemon.ask("component.stop", kSecond)));
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
}

/// A value on probation, then the stop of `second`.
void stop_second_on_probation(TrialDaemon& daemon, const std::string& address) {
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  const Json tried = {{"values", {{address, 3.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", tried)["saved"], true);
  ASSERT_NO_FATAL_FAILURE(stop_second(daemon));
}

class KeptStop : public Generations {};

TEST_F(KeptStop, OfAChangeOnProbationHoldsInTheOlderGeneration) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_NO_FATAL_FAILURE(stop_second_on_probation(daemon, "second.core.gain"));
  ASSERT_EQ(newest(daemon)["mark"], "unconfirmed");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("second")["state"], "stopped") << daemon.errors();
  EXPECT_EQ(daemon.component("first")["state"], "running");
  EXPECT_EQ(daemon.value("second.core.gain"), 1.0) << "the change on probation is lost";
  EXPECT_EQ(exported(daemon)["components"]["second"]["start"], false);
  EXPECT_TRUE(was_logged(daemon, "stays_stopped"));
  EXPECT_TRUE(daemon.says("second: stays stopped, since generation 3")) << daemon.errors();

  crash(daemon);
  daemon.start();
  EXPECT_EQ(daemon.component("second")["state"], "stopped") << "also after the next crash";
}

TEST_F(KeptStop, SoonAfterAStartHoldsWhenTheFileIsStarted) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_NO_FATAL_FAILURE(stop_second(daemon));

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("second")["state"], "stopped") << daemon.errors();
  EXPECT_TRUE(daemon.says("no saved generation can be started")) << daemon.errors();
  end_and_start(daemon);
  EXPECT_EQ(daemon.component("second")["state"], "stopped") << "also after an orderly end";
}

/// mauved answers, and saves, a change that is decided although it has been asked to end.
TEST_F(KeptStop, IsNoneThatTheEndOfMauvedMakes) {
  TrialDaemon daemon(kTrial, options());
  for (int delay = 0; delay < 8; ++delay) {
    ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "so that a start continues with it";
    static_cast<void>(daemon.ask("component.stop", kSecond));
    RawClient client(daemon.socket());
    const auto start = protocol::make_request(1, "component.start", kSecond);
    ASSERT_TRUE(client.send(protocol::to_line(start) + '\n'));
    std::this_thread::sleep_for(std::chrono::milliseconds(delay));  // in each phase of the change

    daemon.process().signal(SIGTERM);
    ASSERT_EQ(daemon.process().wait(), 0) << daemon.errors();
    static_cast<void>(place_.write("state/continue", ""));
    daemon.start();

    ASSERT_TRUE(eventually([&] { return daemon.component("first")["releases"] > 0; }))
        << daemon.component("first") << daemon.errors();
    Json lines = daemon.ask("config.history");
    ASSERT_FALSE(lines["items"].empty()) << lines;
    for (const Json& one : lines["items"]) {
      EXPECT_NE(one.value("command", ""), "") << "the end makes no generation: " << one;
    }
  }
}

TEST_F(KeptStop, OfAFaultedComponentHolds) {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["components"]["second"]["core"] = "trial/throwing_job";
  TrialDaemon daemon(architecture.dump(), options());
  ASSERT_TRUE(eventually([&] { return daemon.component("second")["state"] == "faulted"; }));
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);

  const auto planned =
      daemon.ask("component.stop", {{"components", {"second"}}, {"dry_run", true}});
  EXPECT_EQ(planned["lines"].size(), 1U) << planned;
  const auto stopped = daemon.ask("component.stop", kSecond);

  EXPECT_EQ(stopped["state"], "applied") << stopped;
  EXPECT_EQ(stopped["generation"], 2) << stopped;
  EXPECT_EQ(stopped["components"][0]["name"], "second");
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));
  EXPECT_EQ(daemon.ask("component.stop", kSecond)["state"], "unchanged");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("second")["state"], "stopped") << daemon.errors();
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST_F(KeptStop, EndsWithTheStartOfItsComponent) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_NO_FATAL_FAILURE(stop_second_on_probation(daemon, "first.core.gain"));
  ASSERT_EQ(daemon.ask("component.start", kSecond)["saved"], true);

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("second")["state"], "running") << daemon.errors();
}

/// Without the count, a crash loop would start the same architecture for ever.
TEST_F(KeptStop, LetsCrashesCountForTheGenerationThatRan) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(4.0))["saved"], true);
  const Json tried = {{"values", {{"first.core.gain", 5.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", tried)["saved"], true);
  ASSERT_NO_FATAL_FAILURE(stop_second(daemon));
  crash(daemon);
  for (int crashes = 0; crashes < 3; ++crashes) {
    daemon.start();
    ASSERT_EQ(daemon.value("first.core.gain"), 4.0) << daemon.errors();
    fail(daemon);
  }

  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << daemon.errors();
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  EXPECT_TRUE(was_logged(daemon, "generation_passed_over"));
}

class OtherSystem : public Generations {
 protected:
  [[nodiscard]] static std::string named(const std::string& name) {
    auto file = Json::parse(std::string(kTrial));
    file["name"] = name;
    return file.dump();
  }
  /// True when the log has this text behind its first `before` bytes.
  [[nodiscard]] static bool says_after(const TrialDaemon& daemon, std::size_t before,
                                       const std::string& text) {
    return eventually([&] { return daemon.errors().find(text, before) != std::string::npos; });
  }
};

TEST_F(OtherSystem, IsNotStartedAfterACrashAlthoughItsGenerationIsConfirmed) {
  TrialDaemon daemon(named("first_robot"), options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "of first_robot";
  daemon.place().write("trial.json", kTrial);
  ASSERT_NO_FATAL_FAILURE(end_and_start(daemon));
  ASSERT_EQ(exported(daemon)["name"], "trial");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon)["name"], "trial") << daemon.errors();
}

TEST_F(OtherSystem, IsNotStartedInPlaceOfOneWhoseCodeIsGone) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  crash(daemon);
  const auto plugin = daemon.plugins() / "trial.so";
  std::filesystem::rename(plugin, daemon.place() / "former.so");
  daemon.place().write("trial.json", R"({ "schema": "mauve/architecture/1", "name": "empty" })");

  for (int tries = 0; tries < 2; ++tries) {
    const auto before = daemon.errors().size();
    daemon.start();
    EXPECT_EQ(daemon.process().wait(), 1) << "a service manager tries again";
    EXPECT_TRUE(says_after(daemon, before, "is of architecture \"empty\", but \"trial\" ran"))
        << daemon.errors();
    EXPECT_TRUE(says_after(daemon, before, "mauved --fresh")) << daemon.errors();
  }
  std::filesystem::rename(daemon.place() / "former.so", plugin);
  daemon.start();
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << daemon.errors();

  crash(daemon);
  daemon.start({"--fresh"});
  EXPECT_EQ(exported(daemon)["name"], "empty") << "by hand it is";
}

/// The case of a reload to a build that fails: every generation names the core in quarantine.
TEST_F(OtherSystem, IsNotStartedInPlaceOfOneWithACoreInQuarantine) {
  auto regressing = Json::parse(std::string(kTrial));
  regressing["components"]["first"]["core"] = "trial/regressing";
  TrialDaemon daemon(named("first_robot"), options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "of first_robot";
  daemon.place().write("trial.json", regressing.dump());
  ASSERT_NO_FATAL_FAILURE(end_and_start(daemon));
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "of trial";
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", {{"plugin", "trial"}})["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));
  daemon.place().write("trial.json", named("first_robot"));
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["saved"], true) << "and what came before";
  crash(daemon);
  const auto before = daemon.errors().size();

  daemon.start();
  EXPECT_EQ(daemon.process().wait(), 1);
  EXPECT_TRUE(says_after(daemon, before, "is in quarantine")) << daemon.errors();
  EXPECT_TRUE(says_after(daemon, before, "no saved generation of \"trial\" can be started"))
      << daemon.errors();

  daemon.install(1);
  daemon.start();
  EXPECT_EQ(exported(daemon)["name"], "trial") << daemon.errors();
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

}  // namespace
}  // namespace mauve::test
