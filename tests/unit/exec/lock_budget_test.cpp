// SPDX-License-Identifier: LGPL-3.0-or-later
/// How long a resource is held, as declared: what it means for admission, and how it changes.
#include <gtest/gtest.h>

#include "rt/thread/preemption.h"
#include "support/eventually.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace mauve {
namespace {

struct TableCore : Core<EmptyShell> {
  Stateless stateless{*this};
  void write(const double& /*value*/) {}
};
struct TableInterface : Interface<TableCore> {
  WriteService<double> write{*this, "write", &TableCore::write};
};

struct UserShell : Shell {
  WritePort<double> out{*this, "out"};
};
struct User : Core<UserShell> {
  Stateless stateless{*this};
  void update() { shell().out.write(1.0); }
};
using UserFsm = PeriodicFsm<User>;

TaskAttributes task(int priority, Duration budget) {
  TaskAttributes attributes;
  attributes.priority = priority;
  attributes.cpus = {0};
  attributes.budget = budget;
  return attributes;
}

/// An urgent one that cannot wait for a whole job of the other one.
struct Sharing : Architecture {
  Resource<EmptyShell, TableCore, TableInterface> table{*this, "table"};
  SharedData<double> shared{*this, "shared"};
  mauve::Component<UserShell, User, UserFsm> urgent{*this, "urgent"};
  mauve::Component<UserShell, User, UserFsm> planner{*this, "planner"};

  explicit Sharing(Duration hold = 0ms) {
    urgent.task() = task(30, 1ms);
    planner.task() = task(20, 12ms);
    table.lock().set_budget(hold);
  }
  Status on_configure() override {
    urgent.fsm().period = 10ms;
    planner.fsm().period = 100ms;
    const Status done = urgent.shell().out.connect(table.interface().write);
    return done ? planner.shell().out.connect(table.interface().write) : done;
  }
};

constexpr DeployOptions hold_options(Admission admission) {
  return {.realtime = Realtime::off, .simulated = true, .admission = admission};
}

Change with_lock_budget(const std::string& resource, Duration hold) {
  Edit edit;
  edit.member = resource;
  edit.lock_budget = hold;
  return {{edit}};
}

ComponentTiming of_urgent(const Timing& timing) {
  for (const ComponentTiming& one : timing.components) {
    if (one.name == "urgent") return one;
  }
  ADD_FAILURE() << "urgent is not analysed";
  return {};
}

TEST(Hold, CountsAsBlockingInsteadOfTheWholeJob) {
  Sharing architecture(50us);
  Deployer deployer(architecture, hold_options(Admission::strict));

  const Status deployed = deployer.deploy();

  ASSERT_TRUE(deployed) << to_string(deployed.error());
  const Timing timing = deployer.analyze();
  EXPECT_GE(of_urgent(timing).blocking, 50us);
  EXPECT_LT(of_urgent(timing).blocking, 100us) << "the hold and two switches";
  ASSERT_EQ(timing.locks.size(), 1U) << "shared data has none to speak of";
  EXPECT_EQ(timing.locks[0].resource, "table");
  EXPECT_EQ(timing.locks[0].lock_budget, 50us);
  EXPECT_EQ(timing.locks[0].source, "declared");
}

TEST(Hold, ThatNobodyKnowsCountsAsAWholeJobAndTheRefusalSaysWhatToDeclare) {
  Sharing architecture;
  Deployer strict(architecture, hold_options(Admission::strict));

  const Status deployed = strict.deploy();

  ASSERT_FALSE(deployed);
  EXPECT_EQ(deployed.error().at, "urgent");
  EXPECT_NE(deployed.error().hint.find("declare \"lock_budget\" for resource table"),
            std::string::npos)
      << deployed.error().hint;

  Sharing other;
  Deployer warning(other, hold_options(Admission::warn));
  ASSERT_TRUE(warning.deploy());
  const Timing timing = warning.analyze();
  EXPECT_GE(of_urgent(timing).blocking, 12ms);
  ASSERT_EQ(timing.locks.size(), 1U);
  EXPECT_FALSE(timing.locks[0].lock_budget);
  EXPECT_EQ(timing.locks[0].source, "unknown");
}

TEST(Hold, IsNotBlamedForAJobThatIsLateWithoutIt) {
  Sharing architecture(50us);
  architecture.urgent.task().budget = 11ms;
  Deployer deployer(architecture, hold_options(Admission::strict));

  const Status deployed = deployer.deploy();

  ASSERT_FALSE(deployed);
  EXPECT_EQ(deployed.error().hint.find("lock_budget"), std::string::npos) << deployed.error().hint;
}

TEST(Hold, ChangesInATransactionWithoutAnyThread) {
  Sharing architecture(50us);
  Deployer deployer(architecture, hold_options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(20ms);

  const Result<Receipt> done = deployer.apply(with_lock_budget("table", 2ms));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->generation, 2U);
  ASSERT_EQ(done->components.size(), 1U);
  EXPECT_EQ(done->components[0].name, "table");
  EXPECT_EQ(architecture.table.lock().budget(), 2ms);
  EXPECT_GE(of_urgent(deployer.analyze()).blocking, 2ms);
}

TEST(Hold, ThatWouldMakeAJobLateIsRefusedAndChangesNothing) {
  Sharing architecture(50us);
  Deployer deployer(architecture, hold_options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> longer = deployer.apply(with_lock_budget("table", 11ms));
  const Result<Receipt> unknown = deployer.apply(with_lock_budget("table", 0ms));

  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error().at, "urgent");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().hint.find("declare \"lock_budget\""), std::string::npos);
  EXPECT_EQ(architecture.table.lock().budget(), 50us);
}

TEST(Hold, ThatLastedLongerThanDeclaredContradictsTheAnalysis) {
  if (!rt::preemption_is_reported()) GTEST_SKIP() << "SKIPPED: no hold is measured here";
  Sharing architecture(1ns);
  Deployer deployer(architecture, hold_options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());
  const ResourceLock& lock = architecture.table.lock();

  ASSERT_TRUE(test::eventually([&] {
    deployer.run_for(10ms);
    return lock.longest_held() > 1ns;
  }));

  const std::vector<std::string> found = deployer.analyze().contradictions;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].find("table was held for "), 0U) << found[0];
  EXPECT_NE(found[0].find(", its lock budget is 1ns"), std::string::npos) << found[0];
}

TEST(Hold, ComesBackWhenTheChangeIsRolledBack) {
  Sharing architecture(50us);
  Deployer deployer(architecture, hold_options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());
  Change change = with_lock_budget("table", 1ms);
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(20ms);
  ASSERT_EQ(architecture.table.lock().budget(), 1ms);

  const Status undone = deployer.undo();
  deployer.run_for(20ms);
  Retired retired;
  static_cast<void>(deployer.tend(retired));

  ASSERT_TRUE(undone) << to_string(undone.error());
  EXPECT_EQ(architecture.table.lock().budget(), 50us);
}

TEST(Hold, IsRefusedWhereItHasNoMeaning) {
  Sharing architecture(50us);
  Deployer deployer(architecture, hold_options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  for (const Change& change :
       {with_lock_budget("table", -1us), with_lock_budget("table", 1001ms),
        with_lock_budget("shared", 50us), with_lock_budget("urgent", 50us)}) {
    const Result<Receipt> done = deployer.apply(change);

    ASSERT_FALSE(done) << change.edits[0].member;
    EXPECT_EQ(done.error().at, change.edits[0].member + ".lock_budget");
    EXPECT_FALSE(done.error().message.empty());
  }
  EXPECT_EQ(architecture.table.lock().budget(), 50us);
}

}  // namespace
}  // namespace mauve
