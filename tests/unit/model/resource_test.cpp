// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resources that write on into others, locks, taps, and the wait-free exchange.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <thread>
#include <vector>

#include "rt/latest_value.h"

#include <mauve/architecture.h>
#include <mauve/deployer.h>
#include <mauve/plugin.h>
#include <mauve/tap.h>

namespace mauve {
namespace {

struct RelayShell : Shell {
  WritePort<double> out{*this, "out", Safe{0.0}};
};
/// Writes on what is written to it, times `factor`.
class RelayCore : public Core<RelayShell> {
 public:
  Property<double> factor{*this, "factor", 2.0, "multiplies"};
  Stateless stateless{*this};
  void write(const double& value) { shell().out.write(value * factor); }
};
struct RelayInterface : Interface<RelayCore> {
  WriteService<double> write{*this, "write", &RelayCore::write};
};
using Relay = Resource<RelayShell, RelayCore, RelayInterface>;

struct SourceShell : Shell {
  WritePort<double> out{*this, "out"};
};
class SourceCore : public Core<SourceShell> {
 public:
  void update() { shell().out.write(1.0); }
};

struct Chain : Architecture {
  Relay first{*this, "first"};
  Relay second{*this, "second"};
  SharedData<double> end{*this, "end"};
  Component<SourceShell, SourceCore, PeriodicFsm<SourceCore>> source{*this, "source"};
};

double value_of(SharedDataBase& data) {
  double value = -1;
  Cursor cursor;
  cursor.slot = data.read_service().attach();
  static_cast<void>(data.read_service().read(&value, cursor));
  data.read_service().detach(cursor.slot);
  return value;
}

TEST(Resource, WritesOnThroughItsOwnPorts) {
  Chain chain;
  ASSERT_TRUE(chain.source.shell().out.connect(chain.first.interface().write));
  ASSERT_TRUE(chain.first.shell().out.connect(chain.second.interface().write));
  ASSERT_TRUE(chain.second.shell().out.connect(chain.end.write_service()));
  Deployer deployer(chain, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(10ms);

  EXPECT_EQ(value_of(chain.end), 4.0);
}

TEST(Resource, CycleIsRefusedAtConfigureWithItsPath) {
  Chain chain;
  ASSERT_TRUE(chain.first.shell().out.connect(chain.second.interface().write));
  ASSERT_TRUE(chain.second.shell().out.connect(chain.first.interface().write));

  const Status refused = chain.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::cycle);
  EXPECT_NE(refused.error().message.find("first -> second -> first"), std::string::npos);
}

TEST(Resource, CycleIsRefusedAtConnectOfARunningSystem) {
  Chain chain;
  ASSERT_TRUE(chain.first.shell().out.connect(chain.second.interface().write));
  Deployer deployer(chain, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> cycle = deployer.connect("second.ports.out", "first.write");
  const Result<Receipt> self = deployer.connect("second.ports.out", "second.write");
  const Result<Receipt> fine = deployer.connect("second.ports.out", "end.write");

  ASSERT_FALSE(cycle);
  EXPECT_EQ(cycle.error().code, Errc::cycle);
  ASSERT_FALSE(self);
  EXPECT_TRUE(fine);
}

TEST(Resource, PropertyChangesWhileItIsUsed) {
  Chain chain;
  ASSERT_TRUE(chain.source.shell().out.connect(chain.first.interface().write));
  ASSERT_TRUE(chain.first.shell().out.connect(chain.end.write_service()));
  Deployer deployer(chain, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(10ms);

  const Result<Receipt> done = deployer.set("first.core.factor", 10.0);
  deployer.run_for(10ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(value_of(chain.end), 10.0);
}

TEST(Gate, IsLeftBehindAfterTheBoundOfTheCaller) {
  Gate gate;
  std::atomic<bool> held{false};
  std::atomic<bool> leave{false};
  std::thread holder([&] {
    Entry entry(gate);
    held = true;
    while (!leave) std::this_thread::yield();
  });
  while (!held) std::this_thread::yield();
  this_job().lock_bound = 2ms;

  EXPECT_FALSE(gate.enter());
  EXPECT_EQ(gate.timeouts(), 1u);

  this_job().lock_bound = 0ms;
  leave = true;
  holder.join();
  EXPECT_TRUE(gate.enter());
  gate.leave();
}

TEST(Gate, IsLeftWhenACoreThrows) {
  Gate gate;
  try {
    Entry entry(gate);
    throw 1;
  } catch (int) {
  }
  EXPECT_EQ(this_job().held_count, 0u);
  ASSERT_TRUE(gate.enter());
  gate.leave();
}

TEST(Tap, SeesEveryWriteAndCountsWhatItLost) {
  SharedDataBase data("data", data_type<double>());
  const auto shared = std::make_shared<Tap>(data_type<double>(), 3);
  Tap& tap = *shared;
  ServiceBase& write = data.write_service();
  ASSERT_TRUE(write.taps()->attach(shared, data.gate()));
  for (const double value : {1.0, 2.0, 3.0, 4.0}) write.write(&value);

  std::vector<double> seen;
  while (tap.pop(
      [&](const void* value, Instant) { seen.push_back(*static_cast<const double*>(value)); })) {
  }
  EXPECT_EQ(seen, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(tap.take_lost(), 1u);
  EXPECT_EQ(tap.take_lost(), 0u);
  write.taps()->detach(tap, data.gate());
  const double last = 5.0;
  write.write(&last);
  EXPECT_FALSE(tap.pop([](const void*, Instant) {}));
}

/// A writer that hangs while it holds the resource, until it is let go.
class HangingWriter {
 public:
  explicit HangingWriter(SharedDataBase& data) : thread_([this, &data] { hang(data); }) {
    while (!inside_) std::this_thread::yield();
  }
  ~HangingWriter() { let_go(); }
  HangingWriter(const HangingWriter&) = delete;
  HangingWriter& operator=(const HangingWriter&) = delete;

  void let_go() {
    leave_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  void hang(SharedDataBase& data) {
    auto filler = [this](void* value) {
      inside_ = true;
      while (!leave_) std::this_thread::yield();
      *static_cast<double*>(value) = 9.0;
    };
    static_cast<void>(data.write_service().fill(Filler(filler)));
  }

  std::atomic<bool> inside_{false};
  std::atomic<bool> leave_{false};
  std::thread thread_;
};

TEST(Tap, IsDetachedWhileAWriterHangsAndStaysWhereTheWriterMayLook) {
  SharedDataBase data("data", data_type<double>());
  TapList& list = *data.write_service().taps();
  auto tap = std::make_shared<Tap>(data_type<double>(), 3);
  ASSERT_TRUE(list.attach(tap, data.gate()));
  HangingWriter writer(data);
  this_job().lock_bound = 1ms;

  list.detach(*tap, data.gate());

  this_job().lock_bound = 0ms;
  const std::weak_ptr<Tap> left = tap;
  tap.reset();
  EXPECT_FALSE(left.expired());
  writer.let_go();
  EXPECT_FALSE(left.lock()->pop([](const void*, Instant) {})) << "a closed tap took a value";
  auto other = std::make_shared<Tap>(data_type<double>(), 3);
  ASSERT_TRUE(list.attach(other, data.gate()));
  EXPECT_TRUE(left.expired()) << "the next attach gives it up";
  list.detach(*other, data.gate());
}

TEST(Tap, OfAHangingWriterTakesNoPlaceForEver) {
  SharedDataBase data("data", data_type<double>());
  TapList& list = *data.write_service().taps();
  const auto make = [] { return std::make_shared<Tap>(data_type<double>(), 1); };
  std::vector<std::shared_ptr<Tap>> taps;
  for (std::size_t i = 0; i < TapList::kMaxTaps; ++i) {
    taps.push_back(make());
    ASSERT_TRUE(list.attach(taps.back(), data.gate()));
  }
  EXPECT_EQ(list.attach(make(), data.gate()).error().code, Errc::limit);
  HangingWriter writer(data);
  this_job().lock_bound = 1ms;
  for (const auto& tap : taps) list.detach(*tap, data.gate());
  EXPECT_EQ(list.attach(make(), data.gate()).error().code, Errc::timed_out);
  this_job().lock_bound = 0ms;
  writer.let_go();

  for (auto& tap : taps) EXPECT_TRUE(list.attach(tap = make(), data.gate()));
}

TEST(SharedData, ServesMoreReadersThanItHasSlots) {
  SharedDataBase data("data", data_type<double>());
  const double value = 7.0;
  data.write_service().write(&value);
  for (unsigned reader = 0; reader < SharedDataBase::kReaders + 3; ++reader) {
    Cursor cursor;
    cursor.slot = data.read_service().attach();
    double seen = 0;
    EXPECT_EQ(data.read_service().read(&seen, cursor), DataStatus::new_data);
    EXPECT_EQ(seen, 7.0);
  }
}

TEST(SharedData, AWriterIsNotHeldUpByAnotherThatHangsInIt) {
  SharedDataBase data("data", data_type<double>());
  HangingWriter writer(data);
  const double value = 7.0;

  EXPECT_TRUE(data.write_service().write(&value));

  EXPECT_EQ(value_of(data), 7.0);
  EXPECT_EQ(data.gate().timeouts(), 0u);
  writer.let_go();
  EXPECT_EQ(value_of(data), 9.0);
}

TEST(SharedData, TakesNoValueWhileItIsPoisoned) {
  SharedDataBase data("data", data_type<double>());
  const double first = 7.0;
  ASSERT_TRUE(data.write_service().write(&first));
  data.gate().poison();
  const double second = 8.0;

  EXPECT_FALSE(data.write_service().write(&second));
  EXPECT_EQ(value_of(data), 7.0);

  data.gate().heal();
  EXPECT_TRUE(data.write_service().write(&second));
  EXPECT_EQ(value_of(data), 8.0);
}

/// What is not yet to be read when somebody begins to listen is told to him.
TEST(Tap, MissesNothingOfAWriterThatTakesNoLock) {
  constexpr int kTimes = 2000;
  SharedDataBase data("data", data_type<double>());
  TapList& list = *data.write_service().taps();
  std::atomic<int> round{0};
  std::atomic<int> written{0};
  std::thread writer([&] {
    for (int i = 1; i <= kTimes; ++i) {
      while (round < i) std::this_thread::yield();
      const double value = i;
      EXPECT_TRUE(data.write_service().write(&value));
      written = i;
    }
  });
  int missed = 0;
  for (int i = 1; i <= kTimes; ++i) {
    const auto tap = std::make_shared<Tap>(data_type<double>(), 4);
    round = i;
    EXPECT_TRUE(list.attach(tap, data.gate()));
    const bool was_there = value_of(data) == i;
    while (written < i) std::this_thread::yield();
    const bool told = tap->pop([](const void*, Instant) {});
    missed += was_there || told ? 0 : 1;
    list.detach(*tap, data.gate());
  }
  writer.join();
  EXPECT_EQ(missed, 0);
}

/// Every value carries its number in each word; a torn read would mix two.
struct Numbered {
  std::array<std::uint64_t, 64> words{};
};
Numbered numbered(std::uint64_t number) {
  Numbered value;
  value.words.fill(number);
  return value;
}
/// The number, or 0 for a value that is mixed.
std::uint64_t number_of(const void* data) {
  const auto& words = static_cast<const Numbered*>(data)->words;
  const bool whole = std::all_of(words.begin(), words.end(), [&](auto w) { return w == words[0]; });
  return whole ? words[0] : 0;
}
void write_in_turn(rt::LatestValue& exchange, const Numbered& value) {
  std::memcpy(exchange.begin_write(), &value, sizeof value);
  exchange.end_write(0);
}

TEST(LatestValue, NeverShowsATornOrAnOlderValueOfEitherWriter) {
  rt::LatestValue exchange(sizeof(Numbered), 4);
  std::atomic<bool> done{false};
  std::vector<std::thread> threads;
  std::atomic<int> faults{0};
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&, slot = exchange.attach()] {
      std::array<std::uint64_t, 2> last{};  // odd and even numbers come from two writers
      while (!done) {
        const auto view = exchange.acquire(slot);
        if (view.data == nullptr) continue;
        const std::uint64_t number = number_of(view.data);
        faults += number == 0 || number < last[number % 2] ? 1 : 0;
        last[number % 2] = number;
      }
    });
  }
  threads.emplace_back([&] {
    for (std::uint64_t n = 2; !done; n += 2) write_in_turn(exchange, numbered(n));
  });
  for (std::uint64_t n = 1; n < 100'000; n += 2) {
    const Numbered value = numbered(n);
    EXPECT_TRUE(exchange.try_write(&value, 0));
  }
  done = true;
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(faults, 0);
}

TEST(LatestValue, HoldsAValueStillForEachReaderWhileBothWritersGoOn) {
  rt::LatestValue exchange(sizeof(Numbered), rt::LatestValue::kMaxReaders);
  std::vector<const void*> held;
  std::uint64_t number = 0;
  const auto write_some = [&] {
    for (int i = 0; i < 5; ++i) {
      const Numbered value = numbered(++number);
      ASSERT_TRUE(exchange.try_write(&value, 0));
      write_in_turn(exchange, numbered(++number));
    }
  };
  for (unsigned reader = 0; reader < rt::LatestValue::kMaxReaders; ++reader) {
    write_some();
    held.push_back(exchange.acquire(exchange.attach()).data);
  }
  for (int i = 0; i < 10; ++i) write_some();
  for (std::size_t i = 0; i < held.size(); ++i) EXPECT_EQ(number_of(held[i]), 10 * (i + 1));
}

TEST(LatestValue, IsTheSameUntilItIsWrittenAgain) {
  rt::LatestValue exchange(sizeof(Numbered), 2);
  const unsigned slot = exchange.attach();
  EXPECT_EQ(exchange.acquire(slot).data, nullptr);
  const Numbered value = numbered(1);
  ASSERT_TRUE(exchange.try_write(&value, 7));
  const auto first = exchange.acquire(slot);
  EXPECT_EQ(first.header.stamp, 7);
  EXPECT_EQ(exchange.acquire(slot).header.sequence, first.header.sequence);
  ASSERT_TRUE(exchange.try_write(&value, 8));
  EXPECT_NE(exchange.acquire(slot).header.sequence, first.header.sequence);
}

}  // namespace
}  // namespace mauve
