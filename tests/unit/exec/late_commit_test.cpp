// SPDX-License-Identifier: LGPL-3.0-or-later
/// The coordinator is held up between looking at the clock and deciding, until the instant has
/// passed. The tests move the clock by hand, with the fail points of
/// exec/swap/two_phase_commit.cpp.
#include <gtest/gtest.h>

#include "base/fail_point.h"
#include "exec/swap/two_phase_commit.h"
#include "support/ramp.h"
#include "support/store.h"

namespace mauve {
namespace {

constexpr std::string_view kBeforeDecide = "commit.before_decide";

/// Counts the jobs of all cores of this type.
struct Counted : ramp::Up {
  static int& jobs_of_all() {
    static int count = 0;
    return count;
  }
  void update() override {
    ++jobs_of_all();
    Up::update();
  }
};

struct Two : Architecture {
  SharedData<double> position{*this, "position"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> quick{*this, "quick"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> slow{*this, "slow"};

  Status on_configure() override {
    slow.fsm().period = 1s;
    return quick.shell().out.connect(position.write_service());
  }
};

class LateCommit : public testing::Test {
 protected:
  void SetUp() override {
    Counted::jobs_of_all() = 0;
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(55ms);
  }
  void TearDown() override { at_fail_point() = nullptr; }

  /// In the first `attempts` attempts the boundary of `quick` passes before the decision.
  void hold_up(unsigned attempts) {
    at_fail_point() = [this, attempts](std::string_view point) {
      if (point == kBeforeDecide && held_up++ < attempts) deployer.run_for(10ms);
    };
  }
  Result<Receipt> swap_both() {
    Change change;
    for (const char* name : {"quick", "slow"}) {
      Edit edit;
      edit.member = name;
      edit.core = CoreType::of<Counted>("counted");
      change.edits.push_back(std::move(edit));
    }
    return deployer.apply(change);
  }

  Two architecture;
  Deployer deployer{architecture, {.simulated = true}};
  unsigned held_up = 0;
};

TEST_F(LateCommit, AbortsEveryAttemptAndChangesNothing) {
  const int configured = ramp::Up::configured_cores();
  hold_up(exec::kMaxAttempts);

  const Result<Receipt> refused = swap_both();

  EXPECT_EQ(held_up, exec::kMaxAttempts);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_EQ(refused.error().at, "quick, slow");
  EXPECT_NE(refused.error().message.find("every attempt missed its instant"), std::string::npos);
  deployer.run_for(3s);
  EXPECT_EQ(Counted::jobs_of_all(), 0) << "no member ever ran the new core";
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_NE(deployer.status("quick").core, "counted");
  EXPECT_EQ(deployer.status("quick").missed, 0u);
  EXPECT_EQ(deployer.status("quick").next_release.count() % 10'000'000, 0);
  EXPECT_EQ(ramp::Up::configured_cores(), configured) << "what was prepared is gone";
  const auto jobs = static_cast<double>(deployer.status("quick").releases);
  EXPECT_EQ(ramp::read(architecture.position), jobs) << "the old core kept its state";
}

TEST_F(LateCommit, IsFollowedByAChangeThatWorks) {
  hold_up(exec::kMaxAttempts);
  ASSERT_FALSE(swap_both());

  const Result<Receipt> done = swap_both();

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->attempts, 1u);
  EXPECT_EQ(done->generation, 2u);
  deployer.run_for(2s);
  EXPECT_EQ(deployer.status("quick").core, "counted");
  EXPECT_EQ(deployer.status("slow").core, "counted");
  const auto jobs = static_cast<double>(deployer.status("quick").releases);
  EXPECT_EQ(ramp::read(architecture.position), jobs);
}

TEST_F(LateCommit, TriesAgainUntilTheLastAttempt) {
  hold_up(exec::kMaxAttempts - 1);

  const Result<Receipt> done = swap_both();

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->attempts, exec::kMaxAttempts);
  EXPECT_EQ(deployer.status("quick").missed, 0u);
}

TEST_F(LateCommit, LetsNothingJoinThatRanAJob) {
  hold_up(exec::kMaxAttempts);
  Change change;
  change.edits.push_back(ramp::to_core<ramp::Down>("down", "quick"));
  change.new_components.push_back(
      {std::make_shared<ComponentBase>("joining",
                                       ComponentType{"ramp", ShellType::of<ramp::Shell>(),
                                                     FsmType::of<ramp::Fsm>("ramp"), "counted"},
                                       CoreType::of<Counted>("counted")),
       {}});

  EXPECT_FALSE(deployer.apply(change));
  deployer.run_for(100ms);

  EXPECT_EQ(Counted::jobs_of_all(), 0);
  EXPECT_EQ(deployer.status().size(), 2u);
}

TEST_F(LateCommit, StopsBehindTheJobsThatRanBeforeTheOrderWasPublished) {
  at_fail_point() = [this](std::string_view point) {
    if (point == "commit.before_publish" && held_up++ == 0) deployer.run_for(10ms);
  };

  const Result<Receipt> stopped = deployer.stop({"quick"});

  ASSERT_TRUE(stopped) << to_string(stopped.error());
  EXPECT_EQ(deployer.status("quick").state, ComponentState::stopped);
  EXPECT_GT(stopped->commit, 60ms) << "a job was released then, and ran";
  EXPECT_EQ(stopped->attempts, 1u);
}

/// The members have given their updates back, and the coordinator has not looked at them since. A
/// leak checker tells when one is lost.
TEST(BarrierThatMissesItsInstant, LosesNoUpdateWhenAStopCallsItOff) {
  store::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true, .admission = Admission::off}};
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(20ms);
  auto change = deployer.prepare(store::change_to(store::make<store::Second>("two")));
  ASSERT_TRUE(change) << to_string(change.error());
  at_fail_point() = [&](std::string_view point) {
    if (point == kBeforeDecide) deployer.run_for(10ms);
  };
  const std::shared_ptr<Ongoing> ongoing = deployer.begin(*change);
  at_fail_point() = nullptr;

  EXPECT_TRUE(deployer.stop({"right"}));

  const Result<Receipt> refused = deployer.wait(*ongoing);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::conflict);
}

class LateCommitOnProbation : public LateCommit {
 protected:
  void SetUp() override {
    LateCommit::SetUp();
    Change change{{ramp::to_core<ramp::Down>("down", "quick")}};
    change.probation.emplace();
    ASSERT_TRUE(deployer.apply(change));
    deployer.run_for(20ms);
    ASSERT_TRUE(deployer.on_probation());
  }
  /// The change before is undone when a newer one reaches that point, once.
  void undo_at(std::string_view where) {
    at_fail_point() = [this, where](std::string_view point) {
      if (point == where && held_up++ == 0) undone = deployer.undo().has_value();
    };
  }
  std::vector<Outcome> tend() {
    Retired retired;
    return deployer.tend(retired);
  }
  bool undone = false;
};

TEST_F(LateCommitOnProbation, LeavesTheProbationOfTheChangeBefore) {
  hold_up(exec::kMaxAttempts);
  ASSERT_FALSE(swap_both());

  EXPECT_TRUE(tend().empty());
  EXPECT_TRUE(deployer.on_probation());
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(20ms);
  ASSERT_EQ(tend().size(), 1u);
  EXPECT_EQ(deployer.status("quick").core, "ramp::Up");
}

TEST_F(LateCommitOnProbation, IsRefusedWhenTheChangeBeforeIsLedBackBeforeTheDecision) {
  undo_at(kBeforeDecide);

  const Result<Receipt> refused = swap_both();

  EXPECT_TRUE(undone);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::conflict);
  deployer.run_for(20ms);
  const std::vector<Outcome> ends = tend();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(deployer.status("quick").core, "ramp::Up");
  EXPECT_EQ(Counted::jobs_of_all(), 0);
  EXPECT_TRUE(swap_both());
}

TEST_F(LateCommitOnProbation, IsNotLedBackAnyMoreAfterTheDecision) {
  undo_at("commit.after_decide");

  const Result<Receipt> done = swap_both();

  EXPECT_FALSE(undone);
  ASSERT_TRUE(done) << to_string(done.error());
  deployer.run_for(1s);
  const std::vector<Outcome> ends = tend();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::overtaken);
  EXPECT_EQ(deployer.status("quick").core, "counted");
  EXPECT_EQ(deployer.status("slow").core, "counted");
}

}  // namespace
}  // namespace mauve
