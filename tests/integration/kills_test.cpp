// SPDX-License-Identifier: LGPL-3.0-or-later
/// Nothing that was answered as saved is lost: mauved is killed MAUVE_KILLS times (6), each time
/// right after an answer, in an order of changes that MAUVE_SEED decides. One state directory lives
/// through many kills, as that of a robot.
#include <chrono>
#include <cstdio>
#include <map>
#include <random>

#include "kept_daemon.h"
#include "kept_oracle.h"
#include "kept_robot.h"
#include "support/number_in.h"

namespace mauve::test {
namespace {

using std::chrono::steady_clock;

/// A component of 2 ms has proved itself in six seconds, a start in ten.
constexpr std::chrono::seconds kMayProve{5};

class Kills : public Generations {
 protected:
  /// One run: some changes, then a kill after the answer to one of them, or now and then an end.
  void live(TrialDaemon& daemon) {
    const auto begin = steady_clock::now();
    Robot robot(daemon, state(), oracle_, random_);
    expect_start(robot, daemon);
    if (HasFailure()) return;
    robot.set_quarantined(quarantined_);
    const bool ends = random_() % 12 == 0;
    for (auto left = random_() % 7; left > 0 && !HasFailure(); --left) {
      robot.take(robot.next(), false);
    }
    auto last = robot.next();
    while (!Robot::may_be_last(last)) last = robot.next();
    if (!HasFailure()) robot.take(last, !ends);
    for (const auto& [method, count] : robot.applied()) applied_[method] += count;
    quarantined_ = robot.quarantined();
    if (ends && !HasFailure()) {
      daemon.process().signal(SIGTERM);
      EXPECT_EQ(daemon.process().wait(), 0) << daemon.errors();
    }
    daemon.process().signal(SIGKILL);
    static_cast<void>(daemon.process().wait());
    oracle_.compare(state() / "generations", steady_clock::now() - begin > kMayProve);
    wanted_ = ends ? oracle_.after_end(file_) : oracle_.after_kill(file_);
    story_ = robot.story() + (ends ? "\n  SIGTERM" : "\n  SIGKILL");
  }
  void expect_start(Robot& robot, TrialDaemon& daemon) {
    if (file_.is_null()) file_ = robot.now();
    EXPECT_EQ(robot.now(), wanted_.is_null() ? file_ : wanted_)
        << "the run before:" << story_ << "\n"
        << daemon.errors().substr(daemon.errors().size() -
                                  std::min<std::size_t>(daemon.errors().size(), 2000));
    EXPECT_EQ(robot.quarantine().empty(), !quarantined_) << "the run before:" << story_;
    oracle_.begin(robot.generation(), robot.now());
  }
  /// Another robot.
  void begin_anew() {
    std::filesystem::remove_all(state());
    oracle_ = {};
    wanted_ = nullptr;
    quarantined_ = false;
    story_ = " none";
  }

  const std::uint64_t seed_ = number_in("MAUVE_SEED", 1);
  std::mt19937_64 random_{seed_};
  KeptOracle oracle_;
  Json file_;
  Json wanted_;
  bool quarantined_ = false;
  std::string story_ = " none";
  std::map<std::string, int> applied_;
};

TEST_F(Kills, RightAfterAnAnswerLoseNothingAndStartNothingElse) {
  constexpr std::uint64_t kOfOneRobot = 100;
  constexpr std::uint64_t kCampaign = 500;  // kills, after which each method was accepted
  const auto kills = number_in("MAUVE_KILLS", 6);
  std::printf("seed %lu, %lu kills\n", seed_, kills);
  auto words = options();
  words.insert(words.end(), {"--flight-recorder", "off"});
  TrialDaemon daemon(kTrial, words);
  for (std::uint64_t kill = 1; kill <= kills; ++kill) {
    SCOPED_TRACE("seed " + std::to_string(seed_) + ", kill " + std::to_string(kill));
    live(daemon);
    ASSERT_FALSE(HasFailure()) << "the run:" << story_;
    if (kill % 50 == 0) {
      std::printf("%lu kills\n", kill);
      std::fflush(stdout);
    }
    if (kill % kOfOneRobot == 0) begin_anew();
    daemon.start();
  }
  for (const auto& [method, count] : applied_) std::printf("%6d %s\n", count, method.c_str());
  EXPECT_FALSE(applied_.empty()) << "nothing that mauved accepted was followed by a kill";
  if (kills < kCampaign) return;
  for (const auto* method :
       {"architecture.apply", "change.confirm", "change.undo", "component.start", "component.stop",
        "config.rollback", "core.swap", "lock.set", "log.set_level", "param.set", "plugin.reload",
        "quarantine.release"}) {
    EXPECT_GT(applied_[method], 0) << method;
  }
}

}  // namespace
}  // namespace mauve::test
