// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes that some member does not take since it hangs in its job: on real threads.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "exec/commit/commit.h"
#include "exec/commit/under_way.h"
#include "exec/deploy/bring_up.h"
#include "exec/deploy/shutdown.h"
#include "exec/deploy/stop.h"
#include "exec/prepare/prepare.h"
#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve::exec {
namespace {

using test::eventually;

/// Does not end its job while the gate of its kind is shut.
template <int>
struct Held : ramp::Up {
  void update() override {
    while (shut().load()) {
      inside() = true;
      std::this_thread::sleep_for(1ms);
    }
    ramp::Up::update();
  }
  static std::atomic<bool>& shut() {
    static std::atomic<bool> flag{false};
    return flag;
  }
  static std::atomic<bool>& inside() {
    static std::atomic<bool> flag{false};
    return flag;
  }
};
using Before = Held<0>;
using After = Held<1>;

class Partly : public testing::Test {
 protected:
  void SetUp() override {
    Before::shut() = After::shut() = Before::inside() = false;
    architecture.left.task().watchdog = architecture.right.task().watchdog = 1h;
    ASSERT_TRUE(bring_up(system));
    ASSERT_TRUE(eventually([&] { return releases("left") > 1 && releases("right") > 1; }));
    Before::shut() = true;
    ASSERT_TRUE(eventually([] { return Before::inside().load(); }));
  }
  void TearDown() override {
    Before::shut() = After::shut() = false;
    static_cast<void>(bring_down(system, 10s));
  }

  std::uint64_t releases(const char* name) {
    return system.find(name)->task->counters().releases.load();
  }
  const std::string& core(const char* name) {
    return system.find(name)->component->bundle()->core_type.name;
  }
  /// "left" hangs in a job with the core it has.
  Result<Receipt> apply(Change change, bool probation = true, Duration longest_job = 500ms) {
    if (probation) change.probation.emplace();
    auto prepared = prepare_change(system, change);
    if (!prepared) return prepared.error();
    const auto commit = begin_commit(system, *prepared, TwoPhaseCommit::Kind::change, longest_job);
    static_cast<void>(system.runner->await([&] { return commit->advance(); }, kNever));
    return commit->result();
  }
  /// "left" hangs, and the others change. An attempt that a busy machine delays beyond its bound
  /// has changed nothing, so it is made again.
  template <typename Make>
  Result<Receipt> apply_to_the_others(Make change, bool probation = true) {
    Result<Receipt> result = apply(change(), probation);
    static_cast<void>(eventually([&] {
      if (result || result.error().code != Errc::timed_out) return true;
      result = apply(change(), probation);
      return false;
    }));
    return result;
  }
  /// Nothing hangs.
  bool applied(Change change) {
    return apply(std::move(change), true, test::kPatience).has_value();
  }
  template <typename Right>
  static Change both() {
    return {{ramp::to_core<ramp::Down>("down", "left"), ramp::to_core<Right>("other", "right")}};
  }
  void look() {
    advance(system);
    static_cast<void>(std::exchange(system.retired, {}).release());
  }
  bool runs_on(const char* name) {
    const std::uint64_t before = releases(name);
    return eventually([&] { return look(), releases(name) > before + 2; });
  }

  ramp::Two<Before> architecture;
  System system{architecture, {.realtime = Realtime::off}};
};

TEST_F(Partly, ChangesAreRolledBackOnTheOthers) {
  const std::string before = core("right");

  const Result<Receipt> refused =
      test::refused_for([&] { return apply(both<ramp::Down>()); },
                        [](const Error& error) { return error.at == "left"; });

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_EQ(refused.error().at, "left");
  EXPECT_EQ(core("right"), before);
  EXPECT_EQ(system.generation, 1u) << "there never was another";
  EXPECT_TRUE(runs_on("right"));
  const double low = ramp::read(architecture.right_position);
  EXPECT_TRUE(eventually([&] { return ramp::read(architecture.right_position) > low + 3; }));

  Before::shut() = false;
  EXPECT_TRUE(runs_on("left"));
  EXPECT_TRUE(system.outcomes.empty());
  EXPECT_TRUE(eventually([&] { return look(), system.fading.empty(); }));
  EXPECT_TRUE(applied(both<ramp::Down>())) << "nothing of it is left";
}

/// Otherwise a generation that is saved meanwhile is a mixture of the old one and the new one.
TEST_F(Partly, AChangeShowsInTheModelWholeAndWithItsGeneration) {
  const std::string before = core("right");
  Change change = both<ramp::Down>();
  auto prepared = prepare_change(system, change);
  ASSERT_TRUE(prepared);
  const auto commit = begin_commit(system, *prepared, TwoPhaseCommit::Kind::change, 1h);

  const std::uint64_t began = releases("right");
  ASSERT_TRUE(eventually([&] {
    advance(system);
    return releases("right") > began + 5;  // it runs with its new core, "left" with its old one
  }));
  EXPECT_FALSE(commit->answered());
  EXPECT_EQ(core("right"), before);
  EXPECT_EQ(system.generation, 1u);

  Before::shut() = false;
  ASSERT_TRUE(eventually([&] {
    advance(system);
    return commit->answered();
  }));
  EXPECT_EQ(core("right"), "other");
  EXPECT_EQ(system.generation, 2u);
}

TEST_F(Partly, WhatLeftComesBackAndWhatJoinedLeaves) {
  Change change{{ramp::to_core<ramp::Down>("down", "left")}};
  change.remove = {"right"};
  change.new_components.push_back(
      {std::make_shared<ComponentBase>("third",
                                       ComponentType{"ramp", ShellType::of<ramp::Shell>(),
                                                     FsmType::of<ramp::Fsm>("ramp"), "up"},
                                       CoreType::of<ramp::Up>("up")),
       {}});

  const Result<Receipt> refused = apply(std::move(change));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  ASSERT_NE(system.find("right"), nullptr);
  EXPECT_NE(architecture.find_component("right"), nullptr);
  EXPECT_TRUE(runs_on("right"));
  EXPECT_EQ(system.find("third"), nullptr);
  EXPECT_EQ(architecture.find_component("third"), nullptr);
}

TEST_F(Partly, WhoHangsWithTheNewCoreGoesBackWhenItReturns) {
  const std::string before = core("right");
  After::shut() = true;

  const Result<Receipt> refused = apply_to_the_others(both<After>);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::partly);
  EXPECT_EQ(system.generation, 2u);
  const Result<Receipt> next = apply(both<ramp::Down>());
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, Errc::conflict) << "it is being rolled back";

  After::shut() = false;
  EXPECT_TRUE(eventually([&] { return look(), !system.outcomes.empty(); }));
  ASSERT_EQ(system.outcomes.size(), 1u);
  EXPECT_EQ(system.outcomes[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(system.outcomes[0].component, "") << "no core is to blame";
  EXPECT_EQ(system.generation, 3u);
  EXPECT_EQ(core("right"), before);
  EXPECT_TRUE(runs_on("right"));
}

TEST_F(Partly, ARevokedChangeLeavesTheProbationOfTheOneBefore) {
  const std::string before = core("right");
  ASSERT_TRUE(applied({{ramp::to_core<ramp::Down>("down", "right")}}));

  const Result<Receipt> revoked = apply({{ramp::to_core<ramp::Down>("down", "left")}});

  ASSERT_FALSE(revoked);
  EXPECT_EQ(revoked.error().code, Errc::timed_out);
  EXPECT_TRUE(system.outcomes.empty());
  ASSERT_FALSE(system.probations.empty());
  EXPECT_TRUE(system.probations.back()->undo("undone"));
  EXPECT_TRUE(eventually([&] { return look(), core("right") == before; }));
}

/// "left" hangs with the core of a change on probation, which a change of "right" joins.
TEST_F(Partly, AFollowerThatHangsIsLedBackWithTheOthersWhenItsJobEnds) {
  const std::string before_left = core("left");
  const std::string before_right = core("right");
  Before::shut() = false;
  ASSERT_TRUE(runs_on("left"));
  After::inside() = false;
  ASSERT_TRUE(applied(
      {{ramp::to_core<After>("after", "left"), ramp::to_core<ramp::Down>("down", "right")}}));
  After::shut() = true;
  ASSERT_TRUE(eventually([] { return After::inside().load(); }));

  const Result<Receipt> refused =
      apply_to_the_others([] { return Change{{ramp::to_core<ramp::Up>("up", "right")}}; });

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::partly);
  EXPECT_EQ(refused.error().at, "left");
  EXPECT_TRUE(runs_on("right"));
  After::shut() = false;
  EXPECT_TRUE(eventually([&] { return look(), !system.outcomes.empty(); }));
  ASSERT_EQ(system.outcomes.size(), 1u);
  EXPECT_EQ(system.outcomes[0].generations.front(), 2u);
  EXPECT_EQ(core("left"), before_left) << "both are as before the first change";
  EXPECT_EQ(core("right"), before_right);
  EXPECT_TRUE(runs_on("left"));
}

TEST_F(Partly, WithoutProbationTheMixtureIsReportedAndWhatLeftIsGone) {
  const auto without_right = [] {
    Change change{{ramp::to_core<ramp::Down>("down", "left")}};
    change.remove = {"right"};
    return change;
  };

  const Result<Receipt> refused = apply_to_the_others(without_right, false);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::partly);
  EXPECT_NE(refused.error().message.find("mixture"), std::string::npos);
  EXPECT_EQ(system.deployed.size(), 1u) << "its thread has ended";
  look();
  Before::shut() = false;
  EXPECT_TRUE(runs_on("left"));
}

/// The generation in force when a stop gives up waiting may be that of another change.
TEST_F(Partly, AStopNamesTheGenerationThatItMadeAndNoOther) {
  auto of_left = prepare_change(system, {{ramp::to_core<ramp::Down>("down", "left")}});
  ASSERT_TRUE(of_left);
  const auto change = begin_commit(system, *of_left, TwoPhaseCommit::Kind::change, 1h);
  auto waits = begin_stop(system, {"left"}, std::nullopt);
  ASSERT_TRUE(waits);
  ASSERT_TRUE(apply_to_the_others(
      [] { return Change{{ramp::to_core<ramp::Down>("down", "right")}}; }, false));
  ASSERT_EQ(system.generation, 2u);

  ASSERT_TRUE(eventually([&] { return (*waits)->advance(); }));

  ASSERT_FALSE((*waits)->result());
  EXPECT_EQ((*waits)->result().error().code, Errc::partly);
  EXPECT_EQ((*waits)->made(), 0u) << "it waited for the change of left";
  Before::shut() = false;
  ASSERT_TRUE(eventually([&] { return change->advance(); }));
  EXPECT_EQ(change->made(), 3u);
  auto stops = begin_stop(system, {"right"}, std::nullopt);
  ASSERT_TRUE(stops);
  ASSERT_TRUE(eventually([&] { return (*stops)->advance(); }));
  EXPECT_EQ((*stops)->made(), 4u);
}

}  // namespace
}  // namespace mauve::exec
