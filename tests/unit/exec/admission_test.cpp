// SPDX-License-Identifier: LGPL-3.0-or-later
/// The architectures that are admitted to run, and those that are not, on a clock that is moved by
/// hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/duration.h"
#include "support/ramp.h"

namespace mauve {
namespace {

struct Idle : Core<EmptyShell> {
  Stateless stateless{*this};
  void update() {}
  bool hurries() { return false; }
};
using IdleFsm = PeriodicFsm<Idle>;

/// Two tasks on one CPU; the budgets of the tests make them fit or not.
struct Pair : Architecture {
  mauve::Component<EmptyShell, Idle, IdleFsm> fast{*this, "fast"};
  mauve::Component<EmptyShell, Idle, IdleFsm> slow{*this, "slow"};

  Pair(Duration fast_budget, Duration slow_budget) {
    fast.task() = task(30, fast_budget);
    slow.task() = task(20, slow_budget);
  }
  static TaskAttributes task(int priority, Duration budget) {
    TaskAttributes attributes;
    attributes.priority = priority;
    attributes.cpus = {0};
    attributes.budget = budget;
    return attributes;
  }
  Status on_configure() override {
    fast.fsm().period = 10ms;
    slow.fsm().period = 20ms;
    return ok();
  }
};

/// A quick machine, so that figures of these tests are those of the tasks.
constexpr MachineCosts kQuick{60us, 3us, 15us, 30us};

constexpr DeployOptions options(Admission admission) {
  return {.realtime = Realtime::off, .simulated = true, .admission = admission, .machine = kQuick};
}

Change with_task(const std::string& component, const TaskAttributes& task) {
  Edit edit;
  edit.member = component;
  edit.task = task;
  return {{edit}};
}

Change joining(const std::string& name, Duration budget) {
  auto component = std::make_shared<ComponentBase>(
      name, ComponentType{"idle", ShellType::of<EmptyShell>(), FsmType::of<IdleFsm>("idle"), {}},
      CoreType::of<Idle>("idle"));
  component->task() = Pair::task(10, budget);
  Change change{{}};
  change.new_components.push_back({std::move(component), {}});
  return change;
}

bool says(const std::vector<std::string>& texts, const std::string& part) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

/// "an execution time of 4.65ms would pass (fast.task.budget)"
Duration named_in(const std::string& hint) {
  const std::string before = "an execution time of ";
  const auto from = hint.find(before) + before.size();
  const auto time = parse_duration(hint.substr(from, hint.find(' ', from) - from));
  return time ? *time : Duration{0};
}

TEST(Admission, StrictDeploysWhatFits) {
  Pair architecture(2ms, 4ms);
  Deployer deployer(architecture, options(Admission::strict));

  const Status deployed = deployer.deploy();

  ASSERT_TRUE(deployed) << to_string(deployed.error());
  EXPECT_TRUE(deployer.warnings().empty()) << deployer.warnings().front();
}

TEST(Admission, StrictRefusesADeploymentAndNamesWhatWouldPass) {
  Pair architecture(6ms, 9ms);
  Deployer deployer(architecture, options(Admission::strict));

  const Status deployed = deployer.deploy();

  ASSERT_FALSE(deployed);
  EXPECT_EQ(deployed.error().at, "slow");
  EXPECT_NE(deployed.error().message.find("its deadline is 20ms"), std::string::npos)
      << deployed.error().message;
  EXPECT_EQ(deployed.error().hint, "an execution time of 6.8ms would pass (slow.task.budget)");
  Pair mended(6ms, named_in(deployed.error().hint));
  Deployer other(mended, options(Admission::strict));
  EXPECT_TRUE(other.deploy());
  EXPECT_TRUE(deployer.status().empty());
}

TEST(Admission, StrictRefusesAnUnknownBudgetAndWarnReportsIt) {
  Pair refused(2ms, 0ms);
  Pair warned(2ms, 0ms);
  Deployer strict(refused, options(Admission::strict));
  Deployer warning(warned, options(Admission::warn));

  const Status deployed = strict.deploy();

  ASSERT_FALSE(deployed);
  EXPECT_EQ(deployed.error().at, "slow");
  EXPECT_EQ(deployed.error().hint, "declare a budget, or measure it");
  ASSERT_TRUE(warning.deploy());
  ASSERT_EQ(warning.warnings().size(), 1U);
  EXPECT_TRUE(says(warning.warnings(), "admission: slow: execution times are not known"));
}

TEST(Admission, StrictRefusesAChangeThatAsksForTooMuchAndNothingChanges) {
  Pair architecture(2ms, 4ms);
  Deployer deployer(architecture, options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> done = deployer.apply(with_task("fast", Pair::task(30, 9ms)));

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::limit);
  EXPECT_EQ(done.error().at, "slow");
  EXPECT_EQ(deployer.generation(), 1U);
  EXPECT_EQ(architecture.fast.bundle()->task.budget, 2ms);
}

TEST(Admission, WhatARefusalNamesIsAdmittedExactlyAsItIsPrinted) {
  for (const Duration slow : {4000us, 7300us, 11111us}) {
    for (const Duration wanted : {6000us, 8765us, 9990us, 15000us}) {
      Pair architecture(1ms, slow);
      Deployer deployer(architecture, options(Admission::strict));
      ASSERT_TRUE(deployer.deploy());
      Change change = with_task("fast", Pair::task(30, wanted));
      change.edits[0].core = CoreType::of<Idle>("other");
      const Result<Receipt> refused = deployer.apply(change);
      if (refused) continue;
      EXPECT_NE(refused.error().hint.find("(fast.task.budget)"), std::string::npos)
          << "it is said for what is changed, whoever is late: " << refused.error().hint;

      change.edits[0].task = Pair::task(30, named_in(refused.error().hint));
      const Result<Receipt> done = deployer.apply(change);

      EXPECT_TRUE(done) << refused.error().hint << "; " << to_string(done.error());
    }
  }
}

TEST(Admission, ARefusalSaysWhoPreventsEveryExecutionTime) {
  Pair architecture(1ms, 4ms);
  Deployer deployer(architecture, options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());
  Edit edit;
  edit.member = "fast";
  edit.properties.emplace_back("fsm.period", "20us");

  const Result<Receipt> refused = deployer.apply({{edit}});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().hint.rfind("no execution time of fast would pass, because of ", 0), 0U)
      << refused.error().hint;
}

TEST(Admission, WarnAppliesTheSameChangeAndTheReceiptWarns) {
  Pair architecture(2ms, 4ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> done = deployer.apply(with_task("fast", Pair::task(30, 9ms)));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->generation, 2U);
  EXPECT_TRUE(says(done->warnings, "slow: its job"));
}

TEST(Admission, OffNeitherRefusesNorWarns) {
  Pair architecture(6ms, 0ms);
  Deployer deployer(architecture, options(Admission::off));
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> done = deployer.apply(with_task("fast", Pair::task(30, 9ms)));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_TRUE(done->warnings.empty());
  EXPECT_TRUE(deployer.warnings().empty());
}

TEST(Admission, WarnDoesNotRepeatWhatTheChangeIsNotAbout) {
  Pair architecture(2ms, 0ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> done = deployer.apply(with_task("fast", Pair::task(30, 3ms)));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_TRUE(done->warnings.empty()) << done->warnings.front();
}

TEST(Admission, AChangeThatMendsALateComponentIsNotBlamedForIt) {
  Pair architecture(2ms, 30ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(says(deployer.warnings(), "slow: its job"));

  const Result<Receipt> done = deployer.apply(with_task("slow", Pair::task(20, 4ms)));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_TRUE(done->warnings.empty()) << done->warnings.front();
  EXPECT_TRUE(deployer.analyze().problems.empty());
}

TEST(Admission, WhatLeavesMakesRoom) {
  Pair architecture(4ms, 6ms);
  Deployer deployer(architecture, options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());
  ASSERT_FALSE(deployer.apply(joining("third", 4ms)));
  Change leaving{{}};
  leaving.remove = {"slow"};

  ASSERT_TRUE(deployer.apply(leaving));
  const Result<Receipt> done = deployer.apply(joining("third", 4ms));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_NE(architecture.find_component("third"), nullptr);
}

TEST(Admission, AStoppedComponentAsksForNothingUntilItStarts) {
  Pair architecture(4ms, 6ms);
  Deployer deployer(architecture, options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.stop({"slow"}));
  ASSERT_TRUE(deployer.apply(joining("third", 4ms)));

  const Result<Receipt> started = deployer.start({"slow"});

  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().at, "third");
}

TEST(Admission, OldAndNewMustFitTogetherSinceTheChangeMayBeRolledBack) {
  Pair before(2ms, 14ms);
  Pair after(6ms, 6ms);
  Deployer deployer(before, options(Admission::strict));
  Deployer other(after, options(Admission::strict));
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(other.deploy()) << "each of both fits";
  Change change = with_task("fast", Pair::task(30, 6ms));
  change.edits.push_back(with_task("slow", Pair::task(20, 6ms)).edits.front());

  const Result<Receipt> done = deployer.apply(change);

  ASSERT_FALSE(done) << "6 ms of the new one and 14 ms of the old one";
  EXPECT_EQ(done.error().at, "slow");
}

TEST(Admission, AnalyzeReportsResponsesOfATextbookSet) {
  Pair architecture(3ms, 5ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  const Timing timing = deployer.analyze();

  ASSERT_EQ(timing.components.size(), 2U);
  const ComponentTiming& fast = timing.components[0];
  const ComponentTiming& slow = timing.components[1];
  EXPECT_EQ(fast.name, "fast");
  EXPECT_EQ(fast.cpu, 0);
  EXPECT_EQ(fast.source, "declared");
  EXPECT_EQ(fast.deadline, 10ms);
  EXPECT_EQ(slow.deadline, 20ms);
  ASSERT_TRUE(fast.response && slow.response && slow.slack);
  // 3 ms, and 3 ms + 5 ms, with at most half a millisecond of what the machine costs.
  EXPECT_GE(*fast.response, 3ms);
  EXPECT_LE(*fast.response, 3500us);
  EXPECT_GE(*slow.response, 8ms);
  EXPECT_LE(*slow.response, 8500us);
  EXPECT_EQ(*slow.slack, 20ms - *slow.response);
  ASSERT_EQ(timing.cpus.size(), 1U);
  EXPECT_NEAR(timing.cpus[0].load, 0.55, 0.05);
  ASSERT_TRUE(timing.factor);
  EXPECT_GT(*timing.factor, 1.5);
  EXPECT_LT(*timing.factor, 1.82);
  EXPECT_TRUE(timing.problems.empty());
}

/// Its first job comes once, 6 ms before the first of the others, which are 100 ms apart.
class BootingFsm final : public Fsm<Idle> {
 public:
  Exec update{*this, "update", &Idle::update};
  Sync period{*this, "period", 100ms};
  Exec boot{*this, "boot", &Idle::update};
  Sync soon{*this, "soon", 6ms};

 private:
  Status on_configure() override {
    start_at(boot);
    boot.then(soon);
    soon.then(update);
    update.then(period);
    period.then(update);
    return ok();
  }
};

TEST(Admission, AnalyzeBeginsWithTheInitialState) {
  struct Booting : Architecture {
    mauve::Component<EmptyShell, Idle, BootingFsm> fast{*this, "fast"};
    mauve::Component<EmptyShell, Idle, IdleFsm> slow{*this, "slow"};
    Status on_configure() override {
      slow.fsm().period = 50ms;
      return ok();
    }
  } architecture;
  architecture.fast.task() = Pair::task(30, 3ms);
  architecture.slow.task() = Pair::task(20, 4ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  const Timing timing = deployer.analyze();

  ASSERT_EQ(timing.components.size(), 2U);
  ASSERT_TRUE(timing.components[1].response);
  EXPECT_GE(*timing.components[1].response, 3ms + 4ms + 3ms) << "both jobs of fast delay it";
}

TEST(Admission, AnalyzeSaysWhereItDoesNotKnow) {
  Pair architecture(3ms, 0ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  const Timing timing = deployer.analyze();

  ASSERT_EQ(timing.components.size(), 2U);
  EXPECT_EQ(timing.components[1].source, "unknown");
  EXPECT_NE(timing.components[1].problem, "");
  EXPECT_FALSE(timing.factor);
}

/// Its jobs are 100 ms apart, or 6 ms when its core says so.
class HurryingFsm final : public Fsm<Idle> {
 public:
  Exec update{*this, "update", &Idle::update};
  Sync period{*this, "period", 100ms};
  Sync soon{*this, "soon", 6ms};

 private:
  Status on_configure() override {
    start_at(update);
    update.when(&Idle::hurries, soon).then(period);
    soon.then(update);
    period.then(update);
    return ok();
  }
};

TEST(Admission, AnalyzeCountsWithEveryWayThatAGuardMayOpen) {
  struct Hurrying : Architecture {
    mauve::Component<EmptyShell, Idle, HurryingFsm> fast{*this, "fast"};
    mauve::Component<EmptyShell, Idle, IdleFsm> slow{*this, "slow"};
    Status on_configure() override {
      slow.fsm().period = 50ms;
      return ok();
    }
  } architecture;
  architecture.fast.task() = Pair::task(30, 3ms);
  architecture.slow.task() = Pair::task(20, 4ms);
  Deployer deployer(architecture, options(Admission::warn));
  ASSERT_TRUE(deployer.deploy());

  const Timing timing = deployer.analyze();

  ASSERT_EQ(timing.components.size(), 2U);
  ASSERT_TRUE(timing.components[1].response);
  EXPECT_GE(*timing.components[1].response, 3ms + 4ms + 3ms) << "two jobs of fast delay it";
}

}  // namespace
}  // namespace mauve
