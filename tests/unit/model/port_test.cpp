// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ports of all four kinds, connected and not.
#include <thread>

#include <gtest/gtest.h>

#include <mauve/host/architecture.h>
#include <mauve/plugin.h>

namespace mauve {
namespace {

struct Large {
  std::array<double, 1000> values{};
};

struct ProbeShell : Shell {
  ReadPort<double> in{*this, "in", 42.0};
  ReadPort<double> in_too{*this, "in_too"};
  WritePort<double> out{*this, "out", Safe{0.0}};
  CallPort<double(double, int)> scale{*this, "scale"};
  CallPort<void(double)> note{*this, "note"};
  EventPort<> reset{*this, "reset"};
  ReadPort<Large> large_in{*this, "large_in"};
  WritePort<Large> large_out{*this, "large_out"};
};
class ProbeCore : public Core<ProbeShell> {
 public:
  void update() {}
};

class MeterCore : public Core<EmptyShell> {
 public:
  std::optional<double> value() { return written_ ? std::optional(last_) : std::nullopt; }
  void write(const double& value) {
    written_ = true;
    last_ = value;
  }
  double scale(double value, int factor) { return value * factor; }
  void note(double value) { last_ = value; }
  void reset() { written_ = false; }

 private:
  bool written_ = false;
  double last_ = 0;
};
struct MeterInterface : Interface<MeterCore> {
  ReadService<double> value{*this, "value", &MeterCore::value};
  WriteService<double> write{*this, "write", &MeterCore::write};
  CallService<double(double, int)> scale{*this, "scale", &MeterCore::scale};
  CallService<void(double)> note{*this, "note", &MeterCore::note};
  EventService<> reset{*this, "reset", &MeterCore::reset};
};

struct Bench : Architecture {
  Component<ProbeShell, ProbeCore, PeriodicFsm<ProbeCore>> probe{*this, "probe"};
  Resource<EmptyShell, MeterCore, MeterInterface> meter{*this, "meter"};
  SharedData<double> data{*this, "data"};
  SharedData<Large> large{*this, "large"};
  RingBuffer<double> queue{*this, "queue"};
};

TEST(Port, UnconnectedGivesDefaultsAndNeverThrows) {
  Bench bench;
  ASSERT_TRUE(bench.configure());
  ProbeShell& shell = bench.probe.shell();

  EXPECT_EQ(shell.in.read(), 42.0);
  EXPECT_EQ(shell.in.status(), DataStatus::no_data);
  EXPECT_FALSE(shell.out.write(1.0));
  EXPECT_EQ(shell.out.failures(), 1u);
  EXPECT_FALSE(shell.scale(1.0, 2).has_value());
  EXPECT_FALSE(shell.note(1.0));
  EXPECT_FALSE(shell.reset());
}

TEST(Port, ReachesTheServicesOfAResource) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.in.connect(bench.meter.interface().value));
  ASSERT_TRUE(shell.out.connect(bench.meter.interface().write));
  ASSERT_TRUE(shell.scale.connect(bench.meter.interface().scale));
  ASSERT_TRUE(shell.note.connect(bench.meter.interface().note));
  ASSERT_TRUE(shell.reset.connect(bench.meter.interface().reset));
  ASSERT_TRUE(bench.configure());

  EXPECT_EQ(shell.in.read(), 42.0) << "the service has no data yet";
  EXPECT_TRUE(shell.out.write(3.0));
  EXPECT_EQ(shell.in.read(), 3.0);
  EXPECT_EQ(shell.scale(3.0, 7), 21.0);
  EXPECT_TRUE(shell.note(5.0));
  EXPECT_EQ(shell.in.read(), 5.0);
  EXPECT_TRUE(shell.reset());
  EXPECT_EQ(shell.in.read(), 42.0);
}

TEST(Port, IsConnectedAndDisconnectedOnAConfiguredComponent) {
  Bench bench;
  ASSERT_TRUE(bench.configure());
  ServiceBase& service = bench.data.read_service();
  const double value = 3.0;
  bench.data.write_service().write(&value);

  EXPECT_FALSE(bench.probe.shell().in.connected());
  ASSERT_TRUE(bench.probe.connect("in", service, bench.data.keep_alive()));
  EXPECT_TRUE(bench.probe.shell().in.connected());
  EXPECT_FALSE(bench.probe.shell().in_too.connected()) << "another port";
  EXPECT_EQ(bench.probe.shell().in.read(), 3.0);
  EXPECT_EQ(bench.probe.connect("in", service, nullptr).error().code, Errc::duplicate);
  ASSERT_TRUE(bench.probe.disconnect("in"));
  EXPECT_FALSE(bench.probe.shell().in.connected());
  EXPECT_EQ(bench.probe.shell().in.read(), 42.0);
  EXPECT_EQ(bench.probe.disconnect("in").error().code, Errc::wrong_state);
}

TEST(Port, DistinguishesNewFromOldData) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.in.connect(bench.data.read_service()));
  ASSERT_TRUE(shell.in_too.connect(bench.data.read_service()));
  ASSERT_TRUE(shell.out.connect(bench.data.write_service()));
  ASSERT_TRUE(bench.configure());
  double value = 0;

  EXPECT_EQ(shell.in.read(value), DataStatus::no_data);
  shell.out.write(1.5);
  EXPECT_EQ(shell.in.read(value), DataStatus::new_data);
  EXPECT_EQ(value, 1.5);
  EXPECT_EQ(shell.in.read(value), DataStatus::old_data);
  EXPECT_EQ(shell.in_too.read(value), DataStatus::new_data) << "each reader for itself";
}

TEST(Port, DetectsStaleDataByTheAgeOfTheWritingJob) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.in.connect(bench.data.read_service(), 50ms));
  ASSERT_TRUE(shell.out.connect(bench.data.write_service()));
  ASSERT_TRUE(bench.configure());
  double value = 0;
  this_job().start = 1'000'000'000;
  shell.out.write(1.0);

  this_job().start += 50'000'000;
  EXPECT_EQ(shell.in.read(value), DataStatus::new_data);
  EXPECT_EQ(shell.in.age(), 50ms);
  this_job().start += 1;
  EXPECT_EQ(shell.in.read(value), DataStatus::stale);
  EXPECT_EQ(value, 1.0) << "a stale value is delivered";
  this_job().start = 0;
}

TEST(Port, LooksAtLargeDataInPlace) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.large_in.connect(bench.large.read_service()));
  ASSERT_TRUE(shell.large_out.connect(bench.large.write_service()));
  ASSERT_TRUE(bench.configure());

  EXPECT_TRUE(shell.large_out.fill([](Large& large) { large.values[999] = 9.0; }));
  double seen = 0;
  EXPECT_EQ(shell.large_in.look([&](const Large& large) { seen = large.values[999]; }),
            DataStatus::new_data);
  EXPECT_EQ(seen, 9.0);
}

TEST(Port, QueueGivesOldestFirstAndDropsTheOldestWhenFull) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.in.connect(bench.queue.read_service()));
  ASSERT_TRUE(shell.out.connect(bench.queue.write_service()));
  ASSERT_TRUE(bench.queue.core().find_property("capacity")->set(3));
  ASSERT_TRUE(bench.configure());

  for (const double value : {1.0, 2.0, 3.0, 4.0}) EXPECT_TRUE(shell.out.write(value));

  EXPECT_EQ(shell.in.read(), 2.0);
  EXPECT_EQ(shell.in.read(), 3.0);
  EXPECT_EQ(shell.in.read(), 4.0);
  EXPECT_EQ(shell.in.read(), 42.0) << "empty";
  EXPECT_EQ(bench.queue.core().find_observable("dropped")->value(), Value(1));
}

TEST(Port, IsRefusedAServiceOfAnotherTypeOrKind) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();

  const Status kind = shell.in.connect(bench.meter.interface().write);
  const Status type = shell.in.connect(bench.large.read_service());
  ASSERT_TRUE(shell.in.connect(bench.data.read_service()));
  const Status twice = shell.in.connect(bench.data.read_service());

  EXPECT_EQ(kind.error().message,
            "is a read double port, but meter.write is a write double service");
  EXPECT_EQ(type.error().code, Errc::type_mismatch);
  EXPECT_EQ(twice.error().message, "is connected to data.read already");
  EXPECT_EQ(shell.in.connect(bench.large.read_service()).error().code, Errc::type_mismatch)
      << "a type that does not fit is the first reason";
}

TEST(Port, ReportsARefusedConnectionThatNobodyLookedAtWhenItIsConfigured) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();

  shell.out.connect(bench.data.read_service());

  const Status configured = bench.configure();
  ASSERT_FALSE(configured);
  EXPECT_EQ(configured.error().at, "probe.ports.out");
  EXPECT_EQ(configured.error().code, Errc::type_mismatch);
}

TEST(Port, LeavesARefusedConnectionToTheCallerThatLookedAtIt) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();

  EXPECT_FALSE(shell.out.connect(bench.data.read_service()));
  shell.out.connect(bench.data.write_service());

  EXPECT_TRUE(bench.configure());
  EXPECT_TRUE(shell.out.connected());
}

TEST(Port, IsNotConnectedOnAThreadThatPrepares) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.out.connect(bench.data.write_service()));
  ASSERT_TRUE(bench.configure());
  this_job().start = 1;
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(shell.out.write(1.0));
  {
    const NoPorts no_ports;
    EXPECT_FALSE(shell.out.write(1.0));
  }
  EXPECT_TRUE(shell.out.write(1.0));
  this_job().start = 0;
}

// `mauvectl show` reads the count of a port while its component runs.
TEST(Port, CountsFailuresWhileAnotherThreadReadsTheCount) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(bench.configure());

  std::jthread reader([&] {
    while (shell.out.failures() < 1000) std::this_thread::yield();
  });
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(shell.out.write(1.0));
  reader.join();

  EXPECT_EQ(shell.out.failures(), 1000U);
}

TEST(Port, QueueKeepsWhenEachValueWasWritten) {
  Bench bench;
  ProbeShell& shell = bench.probe.shell();
  ASSERT_TRUE(shell.in.connect(bench.queue.read_service(), 15ms));
  ASSERT_TRUE(shell.out.connect(bench.queue.write_service()));
  ASSERT_TRUE(bench.configure());
  this_job().start = 1'000'000'000;
  shell.out.write(1.0);
  this_job().start += 10'000'000;
  shell.out.write(2.0);
  this_job().start += 10'000'000;
  double value = 0;

  EXPECT_EQ(shell.in.read(value), DataStatus::stale);
  EXPECT_EQ(shell.in.age(), 20ms);
  EXPECT_EQ(shell.in.read(value), DataStatus::new_data);
  EXPECT_EQ(shell.in.age(), 10ms);
  this_job().start = 0;
}

}  // namespace
}  // namespace mauve
