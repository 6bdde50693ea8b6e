// SPDX-License-Identifier: LGPL-3.0-or-later
/// The paper's clock-based state machine (Listing 3, Fig. 2 and 3).
#include <gtest/gtest.h>

#include "exec/task/task.h"
#include "exec/update/task_update.h"

#include <mauve/host/architecture.h>
#include <mauve/plugin.h>

namespace mauve {
namespace {

/// Records the path <WG, RG, AG> with the clock, with flags for the answers of the guards.
class Guidance : public Core<EmptyShell> {
 public:
  void poll_goal() { visit("WG"); }
  void advance() { visit("RG"); }
  void hold() { visit("AG"); }
  bool has_goal() { return goal; }
  bool arrived() const { return at_goal; }

  bool goal = false;
  bool at_goal = false;
  const ManualClock* clock = nullptr;
  std::vector<std::string> path;

 private:
  void visit(const char* state) {
    path.push_back(state + std::to_string(clock->now() / 1'000'000));
  }
};

struct ControlFsm : Fsm<Guidance> {
  Exec wait_goal{*this, "wait_goal", &Guidance::poll_goal};
  Exec reach_goal{*this, "reach_goal", &Guidance::advance};
  Exec at_goal{*this, "at_goal", &Guidance::hold};
  Sync idle{*this, "idle", 100ms};
  Sync pace{*this, "pace", 10ms};
  Sync settle{*this, "settle", 50ms};

  Status on_configure() override {
    start_at(wait_goal);
    wait_goal.when(&Guidance::has_goal, reach_goal).then(idle);
    reach_goal.when(&Guidance::arrived, at_goal).then(pace);
    at_goal.then(settle);
    idle.then(wait_goal);
    pace.then(reach_goal);
    settle.then(wait_goal);
    return ok();
  }
};

TEST(Fsm, FollowsTheTimelineOfThePaper) {
  ManualClock clock{0};
  ComponentBase component(
      "control", {"control", ShellType::of<EmptyShell>(), FsmType::of<ControlFsm>("f"), ""},
      CoreType::of<Guidance>("g"));
  ASSERT_TRUE(component.configure());
  auto& core = static_cast<Guidance&>(component.core());
  core.clock = &clock;
  exec::Task task("control", clock);
  auto first = std::make_unique<exec::TaskUpdate>();
  first->bundle = component.bundle();
  task.begin(std::move(first), 0);
  const auto step = [&] {
    clock.set(task.next_release());
    task.run_release();
  };

  step();  // WG, SW
  core.goal = true;
  step();  // WG, RG, SR
  step();  // RG, SR
  core.at_goal = true;
  step();  // RG, AG, SA
  core.goal = false;
  step();  // WG

  EXPECT_EQ(core.path, (std::vector<std::string>{"WG0", "WG100", "RG100", "RG110", "RG120", "AG120",
                                                 "WG170"}));
  EXPECT_EQ(component.fsm().grid(), 10ms);
  EXPECT_EQ(component.fsm().shortest_wait(), 10ms);
}

TEST(Fsm, TransitionsAreOrderedTheFirstTrueGuardWins) {
  struct Both : Fsm<Guidance> {
    Exec start{*this, "start", &Guidance::poll_goal};
    Sync first{*this, "first", 1ms};
    Sync second{*this, "second", 2ms};
    Status on_configure() override {
      start_at(start);
      start.when(&Guidance::has_goal, first).when(&Guidance::arrived, second).then(second);
      first.then(start);
      second.then(start);
      return ok();
    }
  } fsm;
  ASSERT_TRUE(fsm.configure());
  Guidance core;
  core.goal = core.at_goal = true;

  EXPECT_EQ(&fsm.start.next(core), &fsm.first);
  core.goal = false;
  EXPECT_EQ(&fsm.start.next(core), &fsm.second);
}

/// State names are printed in graphs, traces and metrics.
TEST(Fsm, RefusesAStateWhoseNameIsNone) {
  struct Forging : Fsm<Guidance> {
    Sync wait{*this, "wait\nsubgraph", 1ms};
    Status on_configure() override {
      start_at(wait);
      wait.then(wait);
      return ok();
    }
  } fsm;

  const Status refused = fsm.configure();

  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("is not a name"), std::string::npos)
      << refused.error().message;
}

TEST(Fsm, RefusesACycleThatNeverWaits) {
  struct Spinning : Fsm<Guidance> {
    Exec a{*this, "a", &Guidance::poll_goal};
    Exec b{*this, "b", &Guidance::advance};
    Sync wait{*this, "wait", 1ms};
    Status on_configure() override {
      start_at(a);
      a.then(b);
      b.when(&Guidance::arrived, wait).then(a);
      wait.then(a);
      return ok();
    }
  } fsm;

  const Status refused = fsm.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::cycle);
  EXPECT_NE(refused.error().message.find("a -> b -> a"), std::string::npos);
  EXPECT_FALSE(fsm.configured());
}

TEST(Fsm, RefusesStatesWithoutSuccessorInitialStateOrWayToThem) {
  struct NoInitial : Fsm<Guidance> {
    Sync wait{*this, "wait", 1ms};
  } no_initial;
  struct NoSuccessor : Fsm<Guidance> {
    Exec a{*this, "a", &Guidance::poll_goal};
    Status on_configure() override { return start_at(a), ok(); }
  } no_successor;
  struct Unreachable : Fsm<Guidance> {
    Sync wait{*this, "wait", 1ms};
    Sync never{*this, "never", 1ms};
    Status on_configure() override {
      start_at(wait);
      wait.then(wait);
      never.then(wait);
      return ok();
    }
  } unreachable;

  EXPECT_NE(no_initial.configure().error().message.find("initial"), std::string::npos);
  EXPECT_NE(no_successor.configure().error().message.find("successor"), std::string::npos);
  EXPECT_NE(unreachable.configure().error().message.find("never be reached"), std::string::npos);
}

TEST(Fsm, CanBeConfiguredAgain) {
  ControlFsm fsm;
  ASSERT_TRUE(fsm.configure());
  ASSERT_TRUE(fsm.cleanup());
  ASSERT_TRUE(fsm.configure());
  EXPECT_EQ(fsm.wait_goal.transitions().size(), 1u);
}

}  // namespace
}  // namespace mauve
