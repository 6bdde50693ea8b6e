// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces of simulated deployments: exact, since their clock is moved by hand.
#include <gtest/gtest.h>

#include <thread>

#include "support/block.h"
#include "support/eventually.h"
#include "support/outcomes.h"
#include "support/ramp.h"
#include "support/traced.h"

namespace mauve {
namespace {

using test::trace_of;
using Lines = std::vector<std::string>;

ManualClock& clock_of(const Deployer& deployer) {
  return const_cast<ManualClock&>(dynamic_cast<const ManualClock&>(deployer.clock()));
}

/// Takes 2 ms in its service.
struct Meter final : Core<EmptyShell> {
  Stateless stateless{*this};
  static ManualClock*& clock() {
    static ManualClock* clock = nullptr;
    return clock;
  }
  void note(const double& /*value*/) {
    if (clock() != nullptr) clock()->advance(2ms);
  }
};
struct MeterInterface : Interface<Meter> {
  WriteService<double> write{*this, "write", &Meter::note};
};

/// Records its value, then writes it.
struct Recorder : ramp::Up {
  TraceEvent value{*this, "value"};
  void update() override {
    ramp::Up::update();
    value(state->value);
    value(-0.25);
  }
};

struct Metering : Architecture {
  Resource<EmptyShell, Meter, MeterInterface> meter{*this, "meter"};
  Component<ramp::Shell, Recorder, ramp::Fsm> control{*this, "control"};

  Status on_configure() override { return control.shell().out.connect(meter.interface().write); }
};

/// Throws in its third job.
struct Bad : ramp::Down {
  void update() override {
    if (++jobs_ == 3) throw std::runtime_error("sensor lost");
    ramp::Down::update();
  }

 private:
  int jobs_ = 0;
};

class Tracing : public testing::Test {
 protected:
  ~Tracing() override {
    set_trace_mode(TraceMode::jobs);
    Meter::clock() = nullptr;
  }
};

class TraceOfARamp : public Tracing {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }

  template <typename T>
  Result<Receipt> swap_to(std::optional<Probation> probation = {}) {
    Change change{{ramp::to_core<T>(class_name(typeid(T)))}};
    change.probation = probation;
    return deployer.apply(change);
  }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(TraceOfARamp, RecordsEveryJobAtItsRelease) {
  deployer.run_for(15ms);

  EXPECT_EQ(trace_of(deployer, "control"),
            (Lines{"-1000000 control started  0 0",         //
                   "0 control release  0 0",                //
                   "0 control begin update 0 0",            //
                   "0 control end update 0 0",              //
                   "0 control wait period 10000000 0",      //
                   "10000000 control release  10000000 0",  //
                   "10000000 control begin update 0 0",     //
                   "10000000 control end update 0 0",       //
                   "10000000 control wait period 20000000 0"}));
  EXPECT_TRUE(trace_of(deployer).empty()) << "reported once";
}

TEST_F(TraceOfARamp, IsEmptyWhileTheModeIsOff) {
  set_trace_mode(TraceMode::off);
  static_cast<void>(trace_of(deployer));
  deployer.run_for(100ms);
  ASSERT_TRUE(swap_to<ramp::Down>());

  EXPECT_TRUE(trace_of(deployer).empty());

  set_trace_mode(TraceMode::jobs);
  deployer.run_for(10ms);
  EXPECT_EQ(trace_of(deployer).size(), 4u) << "the jobs from then on";
}

TEST_F(TraceOfARamp, RecordsASwapWithItsInstantAndTheReleasesOnBothSides) {
  deployer.run_for(15ms);
  static_cast<void>(trace_of(deployer));

  const Result<Receipt> receipt = swap_to<ramp::Down>();
  ASSERT_TRUE(receipt);
  const std::vector<TraceRecord> all = test::drain_trace(deployer);
  const std::string tc = std::to_string(receipt->commit.count());

  Lines lines;
  for (const TraceRecord& record : all) lines.push_back(test::to_text(record));
  const std::string time = std::to_string(Duration{14ms}.count());
  EXPECT_EQ(lines, (Lines{time + " [control] prepare core.swap control 0 0",
                          time + " [control] commit core.swap control " + tc + " 1",
                          time + " [control] member control 0 1",
                          "14000000 control applied change " + tc + " 1"}))
      << "asleep, so it took the change at once";
  EXPECT_EQ(deployer.traced().components[0].change, 1u);

  deployer.run_for(10ms);
  EXPECT_EQ(trace_of(deployer, "control").front(), "20000000 control release  20000000 1");
}

TEST_F(TraceOfARamp, NamesThePropertiesThatACommitSets) {
  ASSERT_TRUE(deployer.set("control.core.step", Value(2.0)));

  const Lines lines = trace_of(deployer, "[control]");
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_NE(lines[1].find("commit param.set control"), std::string::npos) << lines[1];
  EXPECT_NE(lines[3].find("set control.core.step 0 1"), std::string::npos) << lines[3];
}

TEST_F(TraceOfARamp, RecordsAStopAndAStart) {
  deployer.run_for(15ms);
  ASSERT_TRUE(deployer.stop({"control"}));
  static_cast<void>(deployer.run_for(20ms));
  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(20ms);

  const std::vector<TraceRecord> all = test::drain_trace(deployer);
  ASSERT_EQ(test::of_kind(all, TraceKind::stopped).size(), 1u);
  ASSERT_EQ(test::of_kind(all, TraceKind::started).size(), 2u) << "at T0, and now";
  const auto started = test::of_kind(all, TraceKind::started)[1];
  EXPECT_EQ(started.a, Duration{40ms}.count()) << "the next instant of its grid";
  const auto commits = test::of_kind(all, TraceKind::commit);
  ASSERT_EQ(commits.size(), 2u);
  EXPECT_EQ(trace_name(commits[0].name), "component.stop control");
  EXPECT_EQ(trace_name(commits[1].name), "component.start control");
}

TEST_F(TraceOfARamp, RecordsAFaultAndTheRollback) {
  ASSERT_TRUE(swap_to<Bad>(Probation{}));
  deployer.run_for(60ms);
  static_cast<void>(test::tend(deployer));

  const std::vector<TraceRecord> all = test::drain_trace(deployer);
  const auto faults = test::of_kind(all, TraceKind::fault);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(trace_name(faults[0].name), "threw");
  const auto applied = test::of_kind(all, TraceKind::applied);
  ASSERT_EQ(applied.size(), 2u);
  EXPECT_EQ(trace_name(applied[0].name), "change");
  EXPECT_EQ(applied[0].b, 1);
  EXPECT_EQ(trace_name(applied[1].name), "back");
  EXPECT_EQ(applied[1].b, 2) << "the rollback has a number of its own";
  EXPECT_EQ(applied[1].a, faults[0].time + Duration{200us}.count());
  const auto back = test::of_kind(all, TraceKind::rollback);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(trace_name(back[0].name), "core.swap control");
  EXPECT_EQ(back[0].a, applied[1].a);
  EXPECT_EQ(back[0].b, 2);
  const auto releases = test::of_kind(all, TraceKind::release);
  EXPECT_EQ(releases.back().b, 2);
  EXPECT_EQ(deployer.traced().components[0].change, 2u);
}

TEST_F(TraceOfARamp, SaysWhatItIsAbout) {
  const TracedSystem traced = deployer.traced();

  EXPECT_EQ(traced.t0, deployer.t0());
  ASSERT_EQ(traced.components.size(), 1u);
  const TracedComponent& control = traced.components[0];
  EXPECT_EQ(control.name, "control");
  EXPECT_EQ(control.change, 0u) << "as it was deployed";
  EXPECT_EQ(control.period, 10ms);
  EXPECT_EQ(control.initial, "update");
  ASSERT_EQ(control.states.size(), 2u);
  EXPECT_EQ(control.states[1].name, "period");
  EXPECT_TRUE(control.states[1].waits);
  EXPECT_EQ(control.states[1].wait, 10ms);
  EXPECT_EQ(traced.resources, (Lines{"position", "speed"}));
}

TEST_F(TraceOfARamp, SaysSinceWhenAComponentHasItsPriority) {
  EXPECT_LE(deployer.traced().components[0].scheduled, 0) << "since its thread was started";
  deployer.run_for(15ms);
  EXPECT_LE(deployer.traced().components[0].timed, 0);
  ASSERT_TRUE(swap_to<ramp::Down>());
  EXPECT_LE(deployer.traced().components[0].scheduled, 0) << "the swap left it as it was";
  const Instant swapped = deployer.clock().now() - deployer.t0();
  EXPECT_EQ(deployer.traced().components[0].timed, swapped) << "another core takes another time";
  deployer.run_for(30ms);

  Edit edit{};
  edit.member = "control";
  edit.task = architecture.control.bundle()->task;
  edit.task->priority = 33;
  ASSERT_TRUE(deployer.apply(Change{{edit}}));

  const Instant now = deployer.clock().now() - deployer.t0();
  EXPECT_EQ(deployer.traced().components[0].priority, 33);
  EXPECT_EQ(deployer.traced().components[0].scheduled, now);
  EXPECT_GT(now, swapped);
  EXPECT_EQ(deployer.traced().components[0].timed, swapped);

  deployer.run_for(30ms);
  edit.task->budget = 3ms;
  ASSERT_TRUE(deployer.apply(Change{{edit}}));
  EXPECT_EQ(deployer.traced().components[0].timed, deployer.clock().now() - deployer.t0());
  EXPECT_EQ(deployer.traced().components[0].scheduled, now);
}

TEST_F(TraceOfARamp, WhatNobodyCollectsIsOverwrittenAndCounted) {
  deployer.run_for(20s);  // 2000 jobs of four records

  const std::vector<TraceRecord> all = test::drain_trace(deployer);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all[0].kind, TraceKind::lost);
  EXPECT_EQ(trace_name(all[0].thread), "control");
  EXPECT_EQ(all[0].a + static_cast<std::int64_t>(all.size()) - 1, 1 + 2000 * 4);
}

class TraceOfAMeter : public Tracing {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    Meter::clock() = &clock_of(deployer);
  }

  Metering architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(TraceOfAMeter, RecordsLocksAndTheCoresOwnEvents) {
  deployer.run_for(5ms);

  EXPECT_EQ(trace_of(deployer, "control"),
            (Lines{"-1000000 control started  0 0",           //
                   "0 control release  0 0",                  //
                   "0 control begin update 0 0",              //
                   "0 control lock meter 0 0",                //
                   "2000000 control unlock meter 2000000 0",  //
                   "2000000 control user value 0 1.000000",   //
                   "2000000 control user value 0 -0.250000",  //
                   "2000000 control end update 0 0",          //
                   "2000000 control wait period 10000000 0"}));
}

TEST_F(TraceOfAMeter, InDetailRecordsEveryUseOfAPort) {
  set_trace_mode(TraceMode::detail);
  deployer.run_for(5ms);

  const std::vector<TraceRecord> calls =
      test::of_kind(test::drain_trace(deployer), TraceKind::call);
  ASSERT_EQ(calls.size(), 1u);
  EXPECT_EQ(test::to_text(calls[0]), "2000000 control call control.out " +
                                         std::to_string(static_cast<int>(DataStatus::new_data)) +
                                         " 2000000");
}

TEST_F(TraceOfAMeter, RecordsWhichThreadGaveUpWaiting) {
  std::atomic<int> step{0};
  std::thread holder([&] {
    EXPECT_TRUE(architecture.meter.lock().try_enter());
    step = 1;
    while (step != 2) std::this_thread::yield();
    architecture.meter.lock().leave();
  });
  while (step != 1) std::this_thread::yield();
  deployer.run_for(5ms);
  step = 2;
  holder.join();

  const Lines lines = trace_of(deployer, "control");
  ASSERT_GE(lines.size(), 4u);
  EXPECT_EQ(lines[3], "0 control timeout meter 0 0");
}

TEST_F(TraceOfAMeter, AJobThatTookLongerThanItsBudgetSaysSo) {
  TaskAttributes task = architecture.control.bundle()->task;
  task.budget = 1ms;
  Edit edit;
  edit.member = "control";
  edit.task = task;
  ASSERT_TRUE(deployer.apply({{edit}}));
  deployer.run_for(20ms);

  const std::vector<TraceRecord> over =
      test::of_kind(test::drain_trace(deployer), TraceKind::budget);
  ASSERT_FALSE(over.empty());
  EXPECT_EQ(over[0].a, Duration{2ms}.count());
  EXPECT_EQ(over[0].b, Duration{1ms}.count());
}

/// Blocks in its third job; when it is released it records more.
struct Blocking : ramp::Up {
  TraceEvent before{*this, "before"};
  TraceEvent after{*this, "after"};
  void update() override {
    ramp::Up::update();
    before(state->value);
    if (state->value != 3) return;
    test::block()->wait();
    for (int i = 0; i < 100; ++i) after(i);
    over() = true;
  }
  static std::atomic<bool>& over() {
    static std::atomic<bool> over{false};
    return over;
  }
};

TEST(TraceOfALostThread, HasNothingOfItAfterItsComponentWentOnWithoutIt) {
  test::Block block;
  test::block() = &block;
  ramp::FallingBack<Blocking> architecture;
  architecture.left.task().watchdog = 500ms;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  std::vector<TraceRecord> all;
  const auto collect = [&] {
    deployer.drain_trace([&](const TraceRecord& record) {
      if (trace_name(record.thread) == "left") all.push_back(record);
    });
  };
  ASSERT_TRUE(test::eventually([&] {
    collect();
    return !test::of_kind(all, TraceKind::applied).empty();
  })) << "its fallback core took over";
  block.let_go();
  ASSERT_TRUE(test::eventually([] { return Blocking::over().load(); }));
  ASSERT_TRUE(test::runs_on(deployer, "left"));
  collect();

  const auto recorded = test::of_kind(all, TraceKind::user);
  ASSERT_EQ(recorded.size(), 3u) << "of the three jobs before";
  EXPECT_EQ(trace_name(recorded.back().name), "before");
  const auto faults = test::of_kind(all, TraceKind::fault);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(trace_name(faults[0].name), "hung");
  EXPECT_EQ(trace_name(test::of_kind(all, TraceKind::applied)[0].name), "standby");
}

}  // namespace
}  // namespace mauve
