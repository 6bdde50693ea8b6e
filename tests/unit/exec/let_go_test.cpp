// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components that are let go while a stop, or a change, still knows them: on a clock that is moved
/// by hand.
#include <gtest/gtest.h>

#include "exec/commit/commit.h"
#include "exec/commit/under_way.h"
#include "exec/deploy/bring_up.h"
#include "exec/deploy/shutdown.h"
#include "exec/deploy/stop.h"
#include "exec/prepare/prepare.h"
#include "support/ramp.h"

namespace mauve::exec {
namespace {

class LetGo : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bring_up(system));
    run_for(50ms);
  }
  void TearDown() override { static_cast<void>(bring_down(system, 2s)); }

  void run_for(Duration time) { system.runner->run_until(system.runner->now() + time.count()); }
  /// "second" joins on probation.
  std::shared_ptr<Ongoing> let_join() {
    Change change;
    change.new_components.push_back(
        {std::make_shared<ComponentBase>("second",
                                         ComponentType{"ramp", ShellType::of<ramp::Shell>(),
                                                       FsmType::of<ramp::Fsm>("ramp"), "up"},
                                         CoreType::of<ramp::Up>("up")),
         {}});
    auto commit = apply(std::move(change));
    EXPECT_NE(system.find("second"), nullptr);
    if (system.find("second") != nullptr) second = system.find("second")->task;
    run_for(30ms);
    return commit;
  }
  std::shared_ptr<Ongoing> apply(Change change) {
    change.probation.emplace();
    auto prepared = prepare_change(system, change);
    EXPECT_TRUE(prepared) << to_string(prepared.error());
    auto commit = begin_commit(system, *prepared);
    EXPECT_TRUE(wait(*commit));
    return commit;
  }
  bool wait(Ongoing& ongoing) {
    return system.runner->await([&] { return ongoing.advance(); }, kNever) &&
           ongoing.result().has_value();
  }
  void look() {
    advance(system);
    static_cast<void>(std::exchange(system.retired, {}).release());
  }

  ramp::Architecture architecture;
  System system{architecture, {.simulated = true}};
  std::weak_ptr<Task> second;
};

TEST_F(LetGo, WaitsForAnOrderToParkThatIsOnItsWay) {
  let_join();
  {
    ASSERT_TRUE(system.probations.back()->undo("undone"));
    Stop stop(system, {{system.find("second"), system.find("control")}}, kLongestJob);
    ASSERT_TRUE(system.find("second")->changing);

    advance(system);
    EXPECT_NE(system.find("second"), nullptr) << "it takes part in a change";

    EXPECT_TRUE(wait(stop));
    EXPECT_TRUE(stop.hung().empty());
    EXPECT_EQ(system.find("control")->state(), ComponentState::stopped);
  }
  for (int i = 0; i < 5; ++i) look();

  EXPECT_EQ(system.find("second"), nullptr);
  EXPECT_EQ(system.generation, 4u) << "joined, stopped, back";
  EXPECT_TRUE(second.expired()) << "in the end all of it is freed";
}

TEST_F(LetGo, LeavesWhatTheChangeThatBroughtItStillKnows) {
  {
    const auto commit = let_join();
    ASSERT_TRUE(system.probations.back()->undo("undone"));
    run_for(20ms);
    look();
    look();
    EXPECT_EQ(system.find("second"), nullptr);

    EXPECT_FALSE(second.expired()) << "the change names who did not come in time";
  }
  for (int i = 0; i < 5; ++i) look();

  EXPECT_TRUE(second.expired());
}

TEST_F(LetGo, LeavesWhatAStopStillKnows) {
  let_join();
  {
    Stop stop(system, {{system.find("control")}, {system.find("second")}}, kLongestJob);
    ASSERT_TRUE(system.probations.back()->undo("undone"));
    run_for(20ms);
    look();
    look();
    EXPECT_EQ(system.find("second"), nullptr);

    EXPECT_FALSE(second.expired());
    EXPECT_TRUE(wait(stop)) << "and nobody waits for it";
  }
  for (int i = 0; i < 5; ++i) look();

  EXPECT_TRUE(second.expired());
}

TEST_F(LetGo, AStopParksWhatCameBackBeforeItIsInTheBooks) {
  Change change;
  change.remove = {"control"};
  apply(std::move(change));
  ASSERT_EQ(system.find("control"), nullptr);
  ASSERT_TRUE(system.probations.back()->undo("undone"));
  system.runner->wake(*system.deployed.front().task);
  ASSERT_EQ(system.deployed.front().state(), ComponentState::running);

  Stop stop(system, in_order_of_safe_values(system), kLongestJob);
  EXPECT_TRUE(wait(stop));
  look();

  ASSERT_NE(system.find("control"), nullptr);
  EXPECT_EQ(system.find("control")->state(), ComponentState::stopped);
}

/// The guard parked its task, whose thread was abandoned and could not be replaced.
TEST_F(LetGo, AComponentWithoutAThreadGetsItsSafeValuesFromTheCoordinator) {
  ASSERT_NE(ramp::read(architecture.position), -1.0);

  system.deployed.front().task->park_for_good("there is no new thread");
  look();

  EXPECT_EQ(ramp::read(architecture.position), -1.0);
}

struct Scaled final : Core<EmptyShell> {
  ~Scaled() override { orphans += meter().expired() ? 1 : 0; }
  /// The resource of the test.
  static std::weak_ptr<ResourceBase>& meter() {
    static std::weak_ptr<ResourceBase> meter;
    return meter;
  }
  static inline int orphans = 0;  ///< cores that outlived their resource, and so their shell
  Stateless stateless{*this};
  Property<double> scale{*this, "scale", 1.0, "any"};
  void note(const double& /*value*/) {}
};
struct ScaledInterface : Interface<Scaled> {
  WriteService<double> write{*this, "write", &Scaled::note};
};
struct Scaling : ramp::Architecture {
  Scaling() {
    auto made = std::make_shared<ResourceBase>(
        "meter", ResourceType{"meter", ShellType::of<EmptyShell>(), CoreType::of<Scaled>("meter"),
                              detail::make<InterfaceBase, ScaledInterface>});
    Scaled::meter() = made;
    Scaled::orphans = 0;
    own(std::move(made));
  }
};
Change to_scale(double scale) {
  Change change;
  change.edits.resize(1);
  change.edits[0].member = "meter";
  change.edits[0].properties.emplace_back("core.scale", Value(scale));
  change.probation.emplace();
  return change;
}

/// Its probation is over, but a thread may still look at the rollback of the resource.
TEST(LetGoResource, StaysAsLongAsAnEarlierChangeOfItIsLookedAfter) {
  Scaling architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.apply(to_scale(2.0)));
  Change removal;
  removal.remove = {"meter"};
  ASSERT_TRUE(deployer.apply(removal));

  EXPECT_FALSE(Scaled::meter().expired());
  deployer.run_for(1s);
  while (!deployer.settled()) deployer.run_for(10ms);
  static_cast<void>(deployer.collect().release());
  EXPECT_TRUE(Scaled::meter().expired());
}

TEST(LetGoResource, StaysUntilItsEarlierCoresAreFreed) {
  for (const bool settles : {false, true}) {
    Scaling architecture;
    Deployer deployer(architecture, {.simulated = true});
    ASSERT_TRUE(deployer.deploy());
    ASSERT_TRUE(deployer.apply(to_scale(2.0)));
    ASSERT_TRUE(deployer.apply(to_scale(3.0)));  // ends the probation before
    deployer.run_for(settles ? Duration{1s} : Duration{0});
    Change removal;
    removal.remove = {"meter"};
    ASSERT_TRUE(deployer.apply(removal));
    deployer.run_for(1s);
    while (!deployer.settled()) deployer.run_for(10ms);
    static_cast<void>(deployer.collect().release());
    EXPECT_TRUE(Scaled::meter().expired());
    EXPECT_EQ(Scaled::orphans, 1) << "only the last core ends with it; settles: " << settles;
  }
}

}  // namespace
}  // namespace mauve::exec
