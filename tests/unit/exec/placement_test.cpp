// SPDX-License-Identifier: LGPL-3.0-or-later
/// Where components run whose tasks name no CPU: admission must think the same as deployment.
#include <gtest/gtest.h>

#include <algorithm>

#include "rt/thread/thread.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace mauve {
namespace {

/// A resource with a lock, since its core is asked in the caller's job.
class PlacedTable : public Core<EmptyShell> {
 public:
  Stateless stateless{*this};
  void write(const double& value) { last_ = value; }

 private:
  double last_ = 0;
};
struct PlacedTableInterface : Interface<PlacedTable> {
  WriteService<double> write{*this, "write", &PlacedTable::write};
};

struct PlacedUserShell : Shell {
  WritePort<double> out{*this, "out"};
};
struct PlacedUser : Core<PlacedUserShell> {
  Stateless stateless{*this};
  void update() { shell().out.write(1.0); }
};
using PlacedUserFsm = PeriodicFsm<PlacedUser>;

TaskAttributes budgeted() {
  TaskAttributes task;
  task.priority = 20;
  task.budget = 1ms;
  return task;
}

/// Two that share a lock, and one that does not, in this order: alone, first.
struct SharedGrid : Architecture {
  Resource<EmptyShell, PlacedTable, PlacedTableInterface> table{*this, "table"};
  mauve::Component<PlacedUserShell, PlacedUser, PlacedUserFsm> alone{*this, "alone"};
  mauve::Component<PlacedUserShell, PlacedUser, PlacedUserFsm> first{*this, "first"};

  SharedGrid() {
    alone.task() = budgeted();
    first.task() = budgeted();
  }
  Status on_configure() override {
    alone.fsm().period = 50ms;
    first.fsm().period = 50ms;
    return first.shell().out.connect(table.interface().write);
  }
};

/// Named "NAME", connected to the table or not.
NewComponent joining(const std::string& name, bool shares) {
  auto component = std::make_shared<ComponentBase>(
      name,
      ComponentType{
          "user", ShellType::of<PlacedUserShell>(), FsmType::of<PlacedUserFsm>("user"), {}},
      CoreType::of<PlacedUser>("user"));
  component->task() = budgeted();
  NewComponent made{std::move(component), {}};
  if (shares) made.connect.push_back({"out", "table.write"});
  return made;
}

constexpr DeployOptions kStrict{
    .realtime = Realtime::off, .simulated = true, .admission = Admission::strict};

TEST(Placement, RunsWhoSharesALockOnOneCpuAlsoWhenItJoins) {
  SharedGrid architecture;
  Deployer deployer(architecture, kStrict);
  ASSERT_TRUE(deployer.deploy());
  Change change{{}};
  change.new_components.push_back(joining("second", true));
  change.new_components.push_back(joining("third", true));

  const Result<Receipt> done = deployer.apply(change);

  ASSERT_TRUE(done) << "strict thinks of the CPU where it will be: " << to_string(done.error());
  const std::vector<int> cpus = deployer.status("first").cpus;
  EXPECT_EQ(cpus.size(), 1U);
  EXPECT_EQ(deployer.status("second").cpus, cpus);
  EXPECT_EQ(deployer.status("third").cpus, cpus);
}

struct BetweenShell : PlacedUserShell {
  WritePort<double> extra{*this, "extra"};
};
struct Between : Core<BetweenShell> {
  Stateless stateless{*this};
  void update() { shell().out.write(1.0); }
};

/// `between`, listed last, links the two others, which share nothing.
struct Linked : Architecture {
  Resource<EmptyShell, PlacedTable, PlacedTableInterface> table{*this, "table"};
  Resource<EmptyShell, PlacedTable, PlacedTableInterface> desk{*this, "desk"};
  mauve::Component<PlacedUserShell, PlacedUser, PlacedUserFsm> first{*this, "first"};
  mauve::Component<PlacedUserShell, PlacedUser, PlacedUserFsm> second{*this, "second"};
  mauve::Component<BetweenShell, Between, PeriodicFsm<Between>> between{*this, "between"};

  Linked() {
    for (ComponentBase* one : components()) one->task() = budgeted();
  }
  Status on_configure() override {
    first.fsm().period = 50ms;
    second.fsm().period = 50ms;
    between.fsm().period = 50ms;
    for (Status done : {first.shell().out.connect(table.interface().write),
                        second.shell().out.connect(desk.interface().write),
                        between.shell().out.connect(table.interface().write)}) {
      if (!done) return done;
    }
    return between.shell().extra.connect(desk.interface().write);
  }
};

TEST(Placement, RunsWhoIsLinkedByTheLocksOfOthersOnOneCpu) {
  Linked architecture;
  Deployer deployer(architecture, kStrict);

  ASSERT_TRUE(deployer.deploy());

  const std::vector<int> cpus = deployer.status("first").cpus;
  EXPECT_EQ(deployer.status("second").cpus, cpus);
  EXPECT_EQ(deployer.status("between").cpus, cpus);
}

TEST(Placement, TakesTheCpuWithTheFewestOtherwise) {
  if (rt::usable_cpus().size() < 2) GTEST_SKIP() << "NOT TESTED: one CPU only";
  SharedGrid architecture;
  Deployer deployer(architecture, kStrict);
  ASSERT_TRUE(deployer.deploy());

  EXPECT_NE(deployer.status("alone").cpus, deployer.status("first").cpus);
}

TEST(Placement, CountsAHoldThatWasNotMeasuredAsAWholeJob) {
  SharedGrid architecture;
  Deployer deployer(architecture, kStrict);
  ASSERT_TRUE(deployer.deploy());
  TaskAttributes urgent = budgeted();
  urgent.priority = 30;
  NewComponent second = joining("second", true);
  second.component->task() = urgent;
  Change change{{}};
  change.new_components.push_back(std::move(second));
  ASSERT_TRUE(deployer.apply(change));

  const Timing timing = deployer.analyze();

  const auto joined = std::ranges::find(timing.components, "second", &ComponentTiming::name);
  ASSERT_NE(joined, timing.components.end());
  EXPECT_GE(joined->blocking, 1ms) << "the budget of first, which may hold the table so long";
  EXPECT_FALSE(timing.notes.empty());
}

}  // namespace
}  // namespace mauve
