// SPDX-License-Identifier: LGPL-3.0-or-later
// The data that outlive a run: generations, the audit log, and the choice of the start after a
// crash.
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "kept_daemon.h"
#include "rt/thread/run_guarded.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

constexpr const char* kEmpty = R"({ "schema": "mauve/architecture/1", "name": "empty" })";
constexpr const char* kNoComponents = R"({ "schema": "mauve/architecture/1", "name": "trial" })";

TEST_F(Generations, AreListedWithWhoMadeThemAndWhy) {
  TrialDaemon daemon(kTrial, options());

  auto params = gain(3.0);
  params["reason"] = "too slow";
  const auto receipt = daemon.ask("param.set", params);
  const auto history = daemon.ask("config.history");

  EXPECT_EQ(receipt["saved"], true) << receipt;
  EXPECT_EQ(history["state_dir"], state().string());
  ASSERT_EQ(history["items"].size(), 2U) << history;
  for (const auto& item : history["items"]) {
    EXPECT_THAT(item["time"].get<std::string>(),
                testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:.]+Z"));
  }
  EXPECT_EQ(history["items"][1]["command"], "start");
  const auto& last = history["items"][0];
  EXPECT_EQ(last["generation"], 2);
  EXPECT_EQ(last["command"], "param.set");
  EXPECT_EQ(last["reason"], "too slow");
  EXPECT_EQ(last["uid"], geteuid());
  EXPECT_EQ(last["mark"], "confirmed");
  EXPECT_EQ(daemon.ask("config.history", {{"n", 1}})["items"].size(), 1U);
}

TEST_F(Generations, AreArchitectureFilesThatCanBeStartedByHand) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);

  TrialDaemon other(TempDir::read(file("2")));

  EXPECT_EQ(exported(other), exported(daemon));
}

TEST_F(Generations, AreNotKeptWithoutAStateDirectory) {
  TrialDaemon daemon;

  const auto receipt = daemon.ask("param.set", gain(3.0));

  EXPECT_FALSE(receipt.contains("saved"));
  EXPECT_EQ(daemon.ask("config.history")["state_dir"], nullptr);
  EXPECT_EQ(daemon.ask("config.rollback", {{"generation", 1}})["data"]["name"], "unsupported");
}

TEST_F(Generations, ThatSomebodyElseMayHaveWrittenAreNotStartedAfterACrash) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  crash(daemon);
  std::filesystem::permissions(file("2"), std::filesystem::perms(0666));

  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 1.0) << daemon.errors();
  EXPECT_TRUE(daemon.says("chmod o-w " + file("2").string())) << daemon.errors();
}

TEST_F(Generations, ThatCannotBeMadeAnyMoreArePassedOverAtOnce) {
  const auto gate = (place_ / "gate").string();
  setenv("MAUVE_TRIAL_WAITS", gate.c_str(), 1);
  TrialDaemon daemon(
      kTrial, {"--realtime", "off", "--state-dir", state().string(), "--prepare-within", "5s"});
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const auto swapped = daemon.ask(
      "core.swap",
      {{"component", "first"}, {"core", "trial/stuck_constructor"}, {"probation", "off"}});
  ASSERT_EQ(swapped["saved"], true) << swapped;
  crash(daemon);
  static_cast<void>(place_.write("gate", "closed"));

  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << daemon.errors();
  EXPECT_TRUE(daemon.says("generation 3 cannot be started")) << daemon.errors();
  EXPECT_TRUE(daemon.says("constructor did not return within 5s")) << daemon.errors();
  unsetenv("MAUVE_TRIAL_WAITS");
}

TEST_F(Generations, OfAFileWhoseCodeCrashesWhenItIsMadeAreNone) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer reports a crash in its own way";
  std::string file(kTrial);
  const std::string type = R"("trial/unit",)";
  file.replace(file.find(type), type.size(), type + R"( "core": "trial/crashing_constructor",)");
  TrialDaemon daemon(file, options());

  EXPECT_EQ(daemon.process().wait(), 1) << "a refusal, and no crash to be counted";
  EXPECT_TRUE(
      daemon.says("first.core: constructor ended the process in which it "
                  "was tried: SIGSEGV"))
      << daemon.errors();
  EXPECT_EQ(TempDir::read(state() / "running"), "ended\n");
}

TEST_F(Generations, AreStartedAfterACrash) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");
  const auto before = exported(daemon);
  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "component.stop"; }));

  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon), before);
  EXPECT_EQ(daemon.component("second")["state"], "stopped") << "a stop outlives a crash";
  EXPECT_EQ(newest(daemon)["command"], "recover");
  EXPECT_TRUE(daemon.says("the last run crashed: starting generation 3")) << daemon.errors();
}

TEST_F(Generations, BeginInTheFolderTheyRanInWhicheverFileIsNamed) {
  const auto folder_of = [](TrialDaemon& daemon) {
    return std::filesystem::read_symlink("/proc/" + std::to_string(daemon.process().id()) + "/cwd");
  };
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const auto folder = folder_of(daemon);
  crash(daemon);

  TrialDaemon other(kTrial, options());
  EXPECT_EQ(newest(other)["command"], "recover");

  EXPECT_EQ(folder_of(other), folder);
}

TEST_F(Generations, OfAFaultedComponentSayThatItStarts) {
  TrialDaemon daemon(kTrial, options());
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");
  const Json other = {{"values", {{"second.core.gain", 3.0}}}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("param.set", other)["saved"], true);

  const auto now = exported(daemon);
  const auto saved = Json::parse(TempDir::read(file("4")), nullptr, true, true);
  const auto difference = daemon.ask("architecture.diff", {{"text", now.dump()}});

  EXPECT_FALSE(now["components"]["first"].contains("start")) << now;
  EXPECT_EQ(now["components"]["second"]["start"], false) << "it was stopped by request";
  EXPECT_EQ(saved["components"], now["components"]);
  EXPECT_EQ(difference["same"], true) << difference;
}

TEST_F(Generations, AreNotStartedAfterAnOrderlyEndAndTheirNumbersGoOn) {
  TrialDaemon daemon(kTrial, options());
  const auto as_in_the_file = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["generation"], 2);

  end_and_start(daemon);

  EXPECT_EQ(exported(daemon), as_in_the_file);
  EXPECT_EQ(daemon.ask("status.get")["generation"], 3);
  EXPECT_EQ(daemon.ask("param.set", gain(2.0))["generation"], 4);
  EXPECT_EQ(newest(daemon)["generation"], 4);
}

TEST_F(Generations, AreIgnoredWhenAFreshStartIsAskedFor) {
  TrialDaemon daemon(kTrial, options());
  const auto as_in_the_file = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  crash(daemon);

  daemon.start({"--fresh"});

  EXPECT_EQ(exported(daemon), as_in_the_file);
  EXPECT_EQ(newest(daemon)["command"], "start");
}

TEST_F(Generations, LeaveTheFileWhenNoneCanBeBuilt) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  crash(daemon);
  std::filesystem::remove(daemon.plugins() / "trial.so");
  daemon.place().write("trial.json", kNoComponents);

  daemon.start();

  EXPECT_FALSE(exported(daemon)["components"].contains("first"));
  EXPECT_EQ(exported(daemon)["plugins"], Json::array()) << "nothing of a generation stays behind";
  EXPECT_TRUE(daemon.says("no saved generation can be started")) << daemon.errors();
}

TEST_F(Generations, AreTheOldOnesOrTheNewOnesAfterAPowerCutAtAnyPoint) {
  const std::vector<std::pair<std::string, bool>> points = {
      {"commit.before_decide", false},
      {"commit.after_decide", false},
      {"generations.before_write@3", false},
      {"generations.after_write@3", false},
      {"generations.after_fsync@3", false},
      {"generations.after_rename@3", true},
      {"generations.after_directory_fsync@3", true}};
  for (const auto& [point, in_force] : points) {
    std::filesystem::remove_all(state());
    setenv("MAUVE_FAIL", point.c_str(), 1);
    auto words = options();
    words.insert(words.end(), {"--flight-recorder", "off"});  // a late job would be one more file
    TrialDaemon daemon(kTrial, words, MAUVE_TRIAL_DIR "/mauved_fail");
    unsetenv("MAUVE_FAIL");
    auto expected = exported(daemon);
    if (in_force) {
      expected["components"]["first"]["properties"]["core.gain"] = 3.0;
    }
    ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
    auto client = daemon.client();

    static_cast<void>(client.ask("param.set", gain(3.0)));  // no answer comes
    ASSERT_EQ(daemon.process().wait(), 86) << point << daemon.errors();
    daemon.start();

    EXPECT_EQ(exported(daemon), expected) << point;
    EXPECT_EQ(newest(daemon)["command"], "recover") << point;
  }
}

/// No file may grow while it lives.
class FullDisk {
 public:
  explicit FullDisk(pid_t process) : process_(process) { limit(0); }
  ~FullDisk() { limit(RLIM_INFINITY); }

 private:
  void limit(rlim_t bytes) const {
    rlimit now{};
    EXPECT_EQ(prlimit(process_, RLIMIT_FSIZE, nullptr, &now), 0);
    now.rlim_cur = std::min(bytes, now.rlim_max);
    EXPECT_EQ(prlimit(process_, RLIMIT_FSIZE, &now, nullptr), 0);
  }

  pid_t process_;
};

TEST_F(Generations, AreReportedAsNotSavedWhenTheDiskIsFull) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const auto intact = TempDir::read(file("2"));
  {
    const FullDisk full(daemon.process().id());

    const auto receipt = daemon.ask("param.set", gain(4.0));

    EXPECT_EQ(receipt["state"], "applied") << receipt;
    EXPECT_EQ(receipt["saved"], false);
    EXPECT_EQ(daemon.value("first.core.gain"), 4.0);
    EXPECT_EQ(daemon.ask("status.get")["saved"], false);
    EXPECT_EQ(newest(daemon)["generation"], 2);
    EXPECT_TRUE(was_logged(daemon, "generation_not_saved"));
    EXPECT_TRUE(was_logged(daemon, "audit_failed"));
    EXPECT_EQ(TempDir::read(file("2")), intact);
    EXPECT_FALSE(std::filesystem::exists(file("3").string() + ".new"));
  }
  EXPECT_EQ(daemon.ask("param.set", gain(5.0))["saved"], true);
  EXPECT_EQ(daemon.ask("status.get")["saved"], true);
  EXPECT_EQ(newest(daemon)["generation"], 4);
}

TEST_F(Generations, OfOneDirectoryBelongToOneDaemon) {
  TrialDaemon daemon(kTrial, options());
  static_cast<void>(daemon.client());

  TrialDaemon second(kTrial, options());

  EXPECT_EQ(second.process().wait(), 1);
  EXPECT_TRUE(second.says("another mauved keeps its generations here")) << second.errors();
}

TEST_F(Generations, AreNotSavedForARefusedChange) {
  TrialDaemon daemon(kTrial, options());

  static_cast<void>(daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/refusing"}}));
  static_cast<void>(daemon.ask("lock.set", {{"lock", "all"}}));  // its answer waits for the disk

  EXPECT_EQ(newest(daemon)["generation"], 1);
}

TEST_F(Generations, KnowThePluginsThatAreLoaded) {
  TrialDaemon daemon(kEmpty, options());
  ASSERT_EQ(daemon.ask("plugin.load", {{"plugin", "trial"}})["saved"], true);
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";

  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon)["plugins"], Json({"trial"}));
}

TEST_F(Generations, AreNamedWhenThereIsNothingToUndo) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);

  const auto refused = daemon.ask("change.undo");

  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;
  EXPECT_EQ(refused["data"]["hint"],
            "mauvectl rollback 1: to before the newest change (~ first.core.gain: 1 -> 3)");
}

TEST_F(Generations, CannotBeRolledBackToWhenTheyAreNotKept) {
  TrialDaemon daemon(kTrial, options());

  const auto error = daemon.ask("config.rollback", {{"generation", 77}});

  EXPECT_EQ(error["data"]["name"], "unknown_name") << error;
  EXPECT_EQ(error["data"]["exit"], 4);
}

using Audit = Generations;

TEST_F(Audit, RecordsWhoChangedWhatAndWhy) {
  TrialDaemon daemon(kTrial, options());
  auto params = gain(3.0);
  params["reason"] = "too slow";

  ASSERT_EQ(daemon.ask("param.set", params)["saved"], true);

  const auto line = audit_line("param.set", "applied");
  EXPECT_EQ(line["uid"], geteuid());
  EXPECT_EQ(line["pid"], getpid());
  EXPECT_EQ(line["program"], "integration_tes") << "as the kernel knows it";
  EXPECT_EQ(line["reason"], "too slow");
  EXPECT_THAT(line["params"].get<std::string>(), HasSubstr("first.core.gain"));
  EXPECT_EQ(line["before"], 1);
  EXPECT_EQ(line["generation"], 2);
  EXPECT_EQ(line["saved"], true);
}

TEST_F(Audit, RecordsWhatWasRefusedAlsoBeforeTheCoordinatorServedIt) {
  TrialDaemon daemon(kTrial, options());

  static_cast<void>(daemon.ask("param.set", {{"valeus", 1}}));
  static_cast<void>(daemon.ask("param.set", gain(11.0)));
  auto late = gain(2.0);
  late["if_generation"] = 7;
  static_cast<void>(daemon.ask("param.set", late));
  static_cast<void>(daemon.ask("lock.set", {{"lock", "all"}}));
  static_cast<void>(daemon.ask("plugin.load", {{"plugin", "trial"}}));

  EXPECT_EQ(audit_line("param.set", "invalid_params")["outcome"], "refused");
  EXPECT_EQ(audit_line("param.set", "invalid_value")["generation"], 1);
  EXPECT_EQ(audit_line("param.set", "conflict")["outcome"], "refused");
  EXPECT_EQ(audit_line("lock.set", "applied")["saved"], true);
  EXPECT_EQ(audit_line("plugin.load", "conflict")["outcome"], "refused");
}

TEST_F(Audit, LosesNoRefusalOfTheLastSecondBeforeAnOrderlyEnd) {
  constexpr std::uint64_t kRefusals = 100;
  TrialDaemon daemon(kTrial, options());
  for (std::uint64_t i = 0; i < kRefusals; ++i) {
    static_cast<void>(daemon.ask("param.set", gain(11.0)));
  }

  daemon.process().signal(SIGTERM);
  ASSERT_EQ(daemon.process().wait(), 0) << daemon.errors();

  std::uint64_t counted = 0;
  for (const auto& line : audit_lines()) {
    counted += line["outcome"] == "refused" ? line.value("count", 1U) : 0U;
  }
  EXPECT_EQ(counted, kRefusals);
}

TEST_F(Audit, GoesOnInTheSameFileAfterARestart) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  std::ofstream(state() / "audit.log", std::ios::app) << R"({"cut o)";

  crash(daemon);
  daemon.start();
  ASSERT_EQ(daemon.ask("param.set", gain(4.0))["saved"], true);

  const auto text = TempDir::read(state() / "audit.log");
  EXPECT_THAT(text, HasSubstr("{\"cut o\n{"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
}

}  // namespace
}  // namespace mauve::test
