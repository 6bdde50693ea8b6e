// SPDX-License-Identifier: LGPL-3.0-or-later
/// The kit that authors test their cores with.
#include <gtest/gtest.h>

#include <mauve/plugin.h>
#include <mauve/test_kit.h>

namespace mauve {
namespace {

struct FollowShell : Shell {
  ReadPort<double> target{*this, "target"};
  WritePort<double> command{*this, "command", Safe{0.0}};
  CallPort<double(double)> limit{*this, "limit"};
};
class Follow : public Core<FollowShell> {
 public:
  Property<double> gain{*this, "gain", 0.5, "pull"};
  void update() {
    const double wanted = shell().target.read() * gain;
    if (shell().target.age() > 100ms) return;
    shell().command.write(shell().limit(wanted).value_or(wanted));
  }
  Status on_configure() override { return gain > 0 ? ok() : invalid(gain, "must be positive"); }
};

TEST(CoreBench, StepsACoreWithValuesSetByHand) {
  CoreBench<FollowShell, Follow> bench;
  bench.core().gain = 0.25;
  ASSERT_TRUE(bench.configure());
  EXPECT_FALSE(bench.written(bench.shell().command).has_value());

  bench.give(bench.shell().target, 8.0);
  bench.core().update();

  EXPECT_EQ(bench.written(bench.shell().command), 2.0);
}

TEST(CoreBench, AnswersCalls) {
  CoreBench<FollowShell, Follow> bench;
  bench.answer(bench.shell().limit, std::function<double(double)>([](double) { return 1.0; }));
  ASSERT_TRUE(bench.configure());
  bench.give(bench.shell().target, 8.0);

  bench.core().update();

  EXPECT_EQ(bench.written(bench.shell().command), 1.0);
}

TEST(CoreBench, MovesTheClockThatAgesAreMeasuredWith) {
  CoreBench<FollowShell, Follow> bench;
  ASSERT_TRUE(bench.configure());
  bench.give(bench.shell().target, 8.0);
  bench.advance(101ms);

  bench.core().update();

  EXPECT_FALSE(bench.written(bench.shell().command).has_value()) << "too old to follow";
}

TEST(CoreBench, FindsAValueStaleThatIsOlderThanTheMaxAgeOfThePort) {
  CoreBench<FollowShell, Follow> bench;
  bench.max_age(bench.shell().target, 50ms);
  ASSERT_TRUE(bench.configure());
  bench.give(bench.shell().target, 8.0);
  double value = 0.0;

  bench.advance(50ms);
  EXPECT_EQ(bench.shell().target.read(value), DataStatus::new_data);
  bench.advance(1ms);
  EXPECT_EQ(bench.shell().target.read(value), DataStatus::stale);
  EXPECT_EQ(value, 8.0) << "a stale value is delivered";
}

TEST(CoreBench, GivesTheTimeOfTheClockAsTheTimeStep) {
  {
    CoreBench<FollowShell, Follow> bench;
    bench.advance(10ms);
    EXPECT_EQ(time_step(), 10ms);
    EXPECT_EQ(to_seconds(time_step()), 0.01);
  }
  EXPECT_EQ(time_step(), 0ms);
}

/// Keeps its last time step.
class Stepping final : public Core<FollowShell> {
 public:
  void update() { step = time_step(); }
  Duration step{0};
};

TEST(ComponentBench, HasATimeStepThatFollowsThePeriod) {
  ComponentBench<FollowShell, Stepping, PeriodicFsm<Stepping>> bench;
  ASSERT_TRUE(bench.deploy());
  bench.run_for(1ms);
  EXPECT_EQ(bench.core().step, 10ms) << "in the first job";

  ASSERT_TRUE(bench.deployer().set("component.fsm.period", "5ms"));
  bench.run_for(100ms);

  EXPECT_EQ(bench.core().step, 5ms);
}

TEST(CoreBench, ReportsARefusedConfiguration) {
  CoreBench<FollowShell, Follow> bench;
  bench.core().gain = -1.0;

  EXPECT_EQ(bench.configure().error().at, "bench.core.gain");
}

TEST(ComponentBench, RunsTheStateMachineOnSimulatedTime) {
  ComponentBench<FollowShell, Follow, PeriodicFsm<Follow>> bench;
  ASSERT_TRUE(bench.deploy());
  bench.ports().give(bench.shell().target, 4.0);

  bench.run_for(100ms);

  EXPECT_EQ(bench.status().releases, 10u);
  EXPECT_EQ(bench.status().missed, 0u);
}

/// This core adds up the values that it reads, in its state or in a member beside it.
template <bool kInState>
class AddingUp final : public Core<FollowShell> {
 public:
  void update() {
    double& sum = kInState ? *state : beside_;
    sum += shell().target.read();
    shell().command.write(sum);
    ++jobs;
  }
  State<double> state{*this};
  Observable<int> jobs{*this, "jobs", 0, "so far"};

 private:
  double beside_ = 0.0;
};
template <bool kInState>
using AddingBench =
    ComponentBench<FollowShell, AddingUp<kInState>, PeriodicFsm<AddingUp<kInState>>>;

template <bool kInState>
std::string difference() {
  using Bench = AddingBench<kInState>;
  return difference_when_renewed<Bench>(
      5, [](Bench& bench) { ASSERT_TRUE(bench.deploy()); },
      [](Bench& bench, int step) {
        bench.ports().give(bench.shell().target, 1.0 + step);
        bench.run_for(10ms);
      });
}

TEST(ComponentBench, FindsNoDifferenceWhereAllThatOutputsAreMadeOfIsInTheState) {
  EXPECT_EQ(difference<true>(), "");
}

TEST(ComponentBench, NamesTheOutputThatASwapOfTheCoreWithItselfChanges) {
  EXPECT_EQ(difference<false>(),
            "ports.command is 3 in step 1, and 2 after a swap of the core with itself: keep what "
            "it is made of in the mauve::State");
}

TEST(ComponentBench, HasTheWrittenValuesAndTheObservablesAsOutputs) {
  AddingBench<true> bench;
  ASSERT_TRUE(bench.deploy());
  EXPECT_EQ(bench.outputs(), (BenchOutputs{{"ports.command", "not written"}, {"core.jobs", "0"}}));
  bench.ports().give(bench.shell().target, 1.5);
  bench.run_for(10ms);
  EXPECT_EQ(bench.outputs(), (BenchOutputs{{"ports.command", "1.5"}, {"core.jobs", "1"}}));
}

TEST(ComponentBench, RenewsTheCoreWithItsValues) {
  ComponentBench<FollowShell, Follow, PeriodicFsm<Follow>> bench;
  bench.core().gain = 0.25;
  ASSERT_TRUE(bench.deploy());
  const Follow* const before = &bench.core();

  ASSERT_TRUE(bench.renew());

  EXPECT_NE(&bench.core(), before);
  EXPECT_EQ(bench.core().gain, 0.25);
}

}  // namespace
}  // namespace mauve
