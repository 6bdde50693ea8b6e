// SPDX-License-Identifier: LGPL-3.0-or-later
// A base that drives on at the last speed it was sent, and a mauved that cannot send another one:
// the bytes on its line are looked at from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>

#include <mauve/host/clock.h>

#include "guarded_base.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"
#include "support/daemon_process.h"
#include "support/fake_base.h"
#include "support/foreign_listener.h"
#include "support/guarded.h"
#include "support/outlet.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST_F(GuardedBase, StandsWhateverSignalEndsMauved) {
  std::vector<int> signals = {SIGKILL, SIGQUIT, SIGXCPU};
  if (rt::kGuardsFaults) signals.insert(signals.end(), {SIGSEGV, SIGABRT, SIGTRAP});
  for (const int signal : signals) {
    start();
    ASSERT_TRUE(drives()) << daemon_->errors();

    daemon_->process().signal(signal);

    EXPECT_NE(daemon_->process().wait(), 0);
    EXPECT_TRUE(daemon_->says("1 of 1 outputs were put into their safe state")) << signal;
    EXPECT_TRUE(stands()) << "after signal " << signal;
    daemon_.reset();
  }
}

TEST_F(GuardedBase, IsLetGoAtAnOrderlyEnd) {
  start();
  ASSERT_TRUE(drives());

  daemon_->process().signal(SIGTERM);

  EXPECT_EQ(daemon_->process().wait(), 0);
  EXPECT_TRUE(daemon_->says("ended in order: its outputs are let go"));
  EXPECT_TRUE(stands()) << "by the driver itself";
}

TEST_F(GuardedBase, StandsWhileMauvedStandsStillAndUntilSomebodyStartsIt) {
  if (!rt::may_use_fifo(95)) GTEST_SKIP() << "NOT TESTED: silence is watched in real time only";
  start({"--realtime", "require", "--state-dir", (place_ / "kept").string()});
  ASSERT_TRUE(drives());

  daemon_->process().signal(SIGSTOP);
  EXPECT_TRUE(daemon_->says("was silent for")) << daemon_->errors();
  EXPECT_TRUE(stands());
  daemon_->process().signal(SIGCONT);

  EXPECT_TRUE(daemon_->says("all components are ordered to stop"));
  EXPECT_TRUE(eventually([&] {
    const Json status = daemon_->ask({"status"});
    return status["components"][0]["state"] == "stopped" &&
           status["components"][1]["state"] == "stopped";
  }));
  EXPECT_TRUE(stands()) << "whatever jobs sent before they were stopped";
  EXPECT_TRUE(eventually([&] {
    return TempDir::read(place_ / "kept" / "audit.log").find("took the outputs") !=
           std::string::npos;
  })) << "the audit log has every change, also this stop";
  EXPECT_EQ(daemon_->client({"start", "cruise", "base"}).wait(), 0);
  EXPECT_TRUE(drives());
}

TEST_F(GuardedBase, IsGuardedAgainWhenItsGuardianWasLost) {
  start();
  const Json before = present_guardian();

  kill(before["process"], SIGKILL);
  EXPECT_TRUE(daemon_->says("the guardian of base.core.stand is lost"));
  EXPECT_TRUE(eventually(
      [&] { return guardian()["present"] == true && guardian()["process"] != before["process"]; }));
  EXPECT_TRUE(daemon_->says("there was none"));
  ASSERT_TRUE(drives());

  daemon_->process().signal(SIGKILL);
  EXPECT_TRUE(stands());
}

/// Nobody else tells the base: the driver has no job any more.
TEST_F(GuardedBase, StandsWhenItsDriverIsStoppedOrRemoved) {
  for (const std::string guardian : {"prefer", "off"}) {
    start({"--realtime", "off", "--guardian", guardian});
    ASSERT_TRUE(drives()) << daemon_->errors();

    ASSERT_EQ(daemon_->client({"stop", "base"}).wait(), 0);
    EXPECT_TRUE(stands()) << guardian;

    ASSERT_EQ(daemon_->client({"start", "base"}).wait(), 0);
    ASSERT_TRUE(drives()) << "after it was started again";
    Json without = guarded_architecture(base_.path());
    without["components"].erase("base");
    const auto file = place_.write("without.json", without.dump());
    ASSERT_EQ(daemon_->client({"apply", file.string()}).wait(), 0) << daemon_->errors();
    EXPECT_TRUE(stands()) << guardian;
    daemon_.reset();
  }
}

/// The order that its driver could not send, or that came before the device did.
TEST_F(GuardedBase, StandsWhenItsLineComesBackWhileItsDriverIsStopped) {
  const auto link = place_ / "line";
  std::optional<FakeBase> line(std::in_place);
  std::filesystem::create_symlink(line->path(), link);
  const auto file = place_.write("guarded.json", guarded_architecture(link).dump());
  daemon_.emplace(file, std::vector<std::string>{"--realtime", "off"});
  ASSERT_TRUE(daemon_->up()) << daemon_->errors();
  ASSERT_TRUE(drives(*line)) << daemon_->errors();
  ASSERT_EQ(daemon_->client({"stop", "base"}).wait(), 0);

  std::filesystem::remove(link);
  line.reset();
  FakeBase back;
  std::filesystem::create_symlink(back.path(), link);

  EXPECT_TRUE(eventually([&] { return back.bytes().ends_with(kStand); })) << daemon_->errors();
}

/// A driver that is told to use another device leaves one that drives on.
TEST_F(GuardedBase, StandsWhenItsDriverLeavesItForAnotherDevice) {
  start();
  ASSERT_TRUE(drives()) << daemon_->errors();
  FakeBase other;

  ASSERT_EQ(daemon_->client({"set", "base.core.device=" + other.path()}).wait(), 0)
      << daemon_->errors();

  EXPECT_TRUE(stands());
  EXPECT_TRUE(drives(other)) << daemon_->errors();
  const std::string heard = other.bytes();
  EXPECT_LT(heard.find(kStream), heard.find(std::string{kDrive, 1})) << "begun before it is driven";
}

TEST_F(GuardedBase, StandsFromTheStartOnWhenTheUserHadStoppedItsDriver) {
  const std::vector<std::string> kept{"--realtime", "off", "--state-dir",
                                      (place_ / "kept").string()};
  start(kept);
  ASSERT_TRUE(drives()) << daemon_->errors();
  ASSERT_EQ(daemon_->client({"stop", "base"}).wait(), 0);
  daemon_.reset();
  const std::size_t before = base_.bytes().size();

  start(kept);

  EXPECT_TRUE(eventually([&] { return base_.bytes().size() > before; })) << daemon_->errors();
  EXPECT_TRUE(stands());
}

/// A thread of another program above the driver, for longer than any job of the driver may take.
TEST_F(GuardedBase, StandsWhileAnotherThreadTakesItsProcessor) {
  if (!rt::may_use_fifo(95)) GTEST_SKIP() << "NOT TESTED: silence is watched in real time only";
  const int cpu = rt::usable_cpus().back();
  Json system = guarded_architecture(base_.path());
  system["components"]["base"]["task"]["cpus"] = {cpu};
  const auto file = place_.write("guarded.json", system.dump());
  daemon_.emplace(file, std::vector<std::string>{"--realtime", "require"});
  ASSERT_TRUE(daemon_->up()) << daemon_->errors();
  ASSERT_TRUE(drives());

  std::atomic<bool> ends{false};
  rt::Thread other;
  ASSERT_TRUE(other.start({"other", 80, {cpu}, 64 * 1024}, [&] {
    const Instant begin = MonotonicClock().now();
    while (!ends && Duration{MonotonicClock().now() - begin} < 800ms) {
    }
  }));

  EXPECT_TRUE(stands()) << "the driver cannot, so it is the guardian";
  ends = true;
  other.join();
  EXPECT_TRUE(daemon_->says("was silent for")) << daemon_->errors();
}

/// It is in the log and in the status, and another process holds the outputs.
TEST_F(GuardedBase, IsGuardedAgainWhenItsGuardianStandsStill) {
  start();
  const Json before = present_guardian();

  kill(before["process"], SIGSTOP);
  EXPECT_TRUE(daemon_->says("it stands still"));
  EXPECT_TRUE(eventually(
      [&] { return guardian()["present"] == true && guardian()["process"] != before["process"]; }));
  EXPECT_TRUE(daemon_->says("there was none"));
  ASSERT_TRUE(drives()) << "all goes on meanwhile";

  daemon_->process().signal(SIGKILL);
  EXPECT_TRUE(stands());
}

TEST_F(GuardedBase, StandsWithoutAGuardianThatIsRequiredUntilSomebodyStartsIt) {
  for (const int signal : {SIGSTOP, SIGKILL}) {
    start({"--realtime", "off", "--guardian", "require"});
    ASSERT_TRUE(drives_when_started()) << daemon_->errors();

    kill(present_guardian()["process"], signal);

    EXPECT_TRUE(daemon_->says("all components are ordered to stop")) << daemon_->errors();
    EXPECT_TRUE(eventually([&] {
      const Json status = daemon_->ask({"status"});
      return status["components"][0]["state"] == "stopped" &&
             status["components"][1]["state"] == "stopped";
    }));
    EXPECT_EQ(present_guardian()["present"], true);
    EXPECT_TRUE(stands());
    EXPECT_TRUE(drives_when_started());
    daemon_.reset();
  }
}

TEST_F(GuardedBase, IsGivenToNoOtherUserWhoListensForIt) {
  std::filesystem::permissions(place_.path(),
                               std::filesystem::perms::all | std::filesystem::perms::sticky_bit);
  const auto socket = (place_ / "mauved.sock").string();
  const ForeignListener impostor(socket + ".guardian", SOCK_SEQPACKET);
  if (!impostor.listens()) GTEST_SKIP() << "NOT TESTED: only root makes a socket of another user";
  const auto log = (place_ / "log").string();
  const auto file = place_.write("guarded.json", guarded_architecture(base_.path()).dump());
  Process mauved({MAUVE_BIN_DIR "/mauved", file.string(), "--socket", socket, "--plugin-dir",
                  MAUVE_PLUGIN_DIR, "--realtime", "off"},
                 log);
  ASSERT_TRUE(drives()) << TempDir::read(log);
  EXPECT_THAT(TempDir::read(log), HasSubstr("a guardian of its own"));
  EXPECT_THAT(TempDir::read(log),
              HasSubstr("a process of user " + std::to_string(ForeignListener::kUser)));

  mauved.signal(SIGKILL);

  EXPECT_TRUE(stands());
}

TEST_F(GuardedBase, PrefersAGuardianThatIsAServiceOfItsOwn) {
  const auto log = (place_ / "guardian.log").string();
  const auto socket = (place_ / "mauved.sock").string();
  Process service({MAUVE_BIN_DIR "/mauve-guardian", "--socket", socket + ".guardian"}, log);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(socket + ".guardian"); }));
  for (int run = 0; run < 2; ++run) {
    std::filesystem::resize_file(log, 0);
    const auto file = place_.write("guarded.json", guarded_architecture(base_.path()).dump());
    Process mauved({MAUVE_BIN_DIR "/mauved", file.string(), "--socket", socket, "--plugin-dir",
                    MAUVE_PLUGIN_DIR, "--realtime", "off"},
                   log);
    ASSERT_TRUE(drives()) << TempDir::read(log);
    EXPECT_THAT(TempDir::read(log), HasSubstr("the guardian service (process " +
                                              std::to_string(service.id()) + ") holds"));
    mauved.signal(SIGKILL);
    EXPECT_TRUE(stands()) << "run " << run;
  }
  EXPECT_TRUE(service.running());
}

TEST_F(GuardedBase, GoesBackToTheServiceWhenItComesBack) {
  start();
  const auto log = (place_ / "guardian.log").string();
  const std::vector<std::string> service{MAUVE_BIN_DIR "/mauve-guardian", "--socket",
                                         daemon_->socket() + ".guardian"};
  for (int run = 0; run < 2; ++run) {
    Process one(service, log);
    EXPECT_TRUE(eventually([&] { return guardian().value("process", 0) == one.id(); }))
        << daemon_->errors();
    one.signal(SIGKILL);
    EXPECT_TRUE(eventually([&] {
      const Json now = guardian();
      return now.value("present", false) && !now.value("service", true);
    })) << "one of its own serves meanwhile";
  }
  ASSERT_TRUE(drives());
  daemon_->process().signal(SIGKILL);
  EXPECT_TRUE(stands());
}

/// Neither moves anything; the brake may share the device.
TEST_F(GuardedBase, HasNoSecondDriverUnderAnyPath) {
  const auto checked = [&](const Json& system) {
    const auto file = place_.write("checked.json", system.dump());
    const auto errors = place_.write("errors", "");
    const auto output = Process({MAUVE_BIN_DIR "/mauved", file.string(), "--check", "--plugin-dir",
                                 MAUVE_PLUGIN_DIR},
                                errors.string())
                            .all_output();
    return output + TempDir::read(errors);
  };
  const std::string has_driver = "is the device of base.core.device";
  Json system = guarded_architecture(base_.path());
  system["resources"]["brake"] = {{"type", "drivers/create_brake"},
                                  {"properties", {{"core.device", base_.path()}}}};
  EXPECT_THAT(checked(system), testing::Not(HasSubstr(has_driver)));

  system["components"]["second"] = system["components"]["base"];
  auto& second = system["components"]["second"]["properties"]["core.device"];
  system["components"]["second"].erase("ports");
  second = "/dev/null";
  EXPECT_THAT(checked(system), testing::Not(HasSubstr(has_driver)));

  second = base_.path();
  EXPECT_THAT(checked(system), HasSubstr("second.core.device: " + base_.path() + " " + has_driver));

  second = "/dev/../dev/" + base_.path().substr(std::string("/dev/").size());
  EXPECT_THAT(checked(system), HasSubstr(has_driver + " as " + base_.path()));

  second = std::filesystem::relative(base_.path()).string();
  EXPECT_THAT(checked(system), HasSubstr(has_driver + " as " + base_.path()));

  system["components"]["third"] = system["components"]["second"];
  const std::string both = checked(system);
  EXPECT_THAT(both, HasSubstr("second.core.device: "));
  EXPECT_THAT(both, HasSubstr("third.core.device: ")) << "each of them is named";
}

TEST_F(GuardedBase, HasNoSecondDriverByAChange) {
  const Outlet another;
  Json system = guarded_architecture(base_.path());
  system["components"]["second"] = system["components"]["base"];
  system["components"]["second"].erase("ports");
  system["components"]["second"]["properties"]["core.device"] = another.path();
  daemon_.emplace(place_.write("two.json", system.dump()),
                  std::vector<std::string>{"--realtime", "off"});
  ASSERT_TRUE(daemon_->up()) << daemon_->errors();

  auto set = daemon_->client({"set", "second.core.device=" + base_.path()});

  EXPECT_NE(set.wait(), 0);
  EXPECT_THAT(set.all_output(), HasSubstr(base_.path() + " is the device of base.core.device"));
}

TEST_F(GuardedBase, HasOneMauvedAtATime) {
  start();
  ASSERT_TRUE(drives());
  const auto file = place_.write("guarded.json", guarded_architecture(base_.path()).dump());
  const auto log = (place_ / "log").string();

  Process other(
      {MAUVE_BIN_DIR "/mauved", file.string(), "--socket", (place_ / "other.sock").string(),
       "--plugin-dir", MAUVE_PLUGIN_DIR, "--realtime", "off"},
      log);

  EXPECT_EQ(other.wait(), 1);
  EXPECT_THAT(TempDir::read(log),
              HasSubstr("belongs to process " + std::to_string(daemon_->process().id())));
  EXPECT_TRUE(daemon_->process().running());
}

/// A copy of mauved in a folder where no guardian lies beside it.
TEST_F(GuardedBase, IsRefusedWithoutAGuardianThatIsRequired) {
  std::filesystem::create_directory(place_ / "bin");
  std::filesystem::copy_file(MAUVE_BIN_DIR "/mauved", place_ / "bin/mauved");
  std::filesystem::create_directory_symlink(MAUVE_BIN_DIR "/../lib", place_ / "lib");
  const auto file = place_.write("guarded.json", guarded_architecture(base_.path()).dump());
  const auto log = (place_ / "log").string();
  Process mauved({(place_ / "bin/mauved").string(), file.string(), "--socket",
                  (place_ / "mauved.sock").string(), "--plugin-dir", MAUVE_PLUGIN_DIR, "--realtime",
                  "off", "--guardian", "require"},
                 log);

  EXPECT_EQ(mauved.wait(), 1);
  EXPECT_THAT(TempDir::read(log), HasSubstr("no guardian serves, and --guardian require asks for "
                                            "one: "));
  EXPECT_EQ(base_.bytes(), "") << "no element was made";
}

}  // namespace
}  // namespace mauve::test
