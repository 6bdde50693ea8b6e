// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resources that write on into others, locks, and taps.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <thread>
#include <vector>

#include "unit/model/shared_data_users.h"

#include <mauve/detail/tap.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/plugin.h>

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

TEST(Resource, UsesAConnectionThatIsMadeWhenItIsConfigured) {
  Chain chain;
  ASSERT_TRUE(chain.configure());
  const auto write = [&chain](double value) { return chain.first.interface().write.write(&value); };

  ASSERT_TRUE(chain.first.connect("out", chain.end.write_service(), nullptr, Duration{0}));
  ASSERT_TRUE(write(3.0));
  EXPECT_EQ(value_of(chain.end), 6.0);

  ASSERT_TRUE(chain.first.disconnect("out"));
  static_cast<void>(write(4.0));
  EXPECT_EQ(value_of(chain.end), 6.0);
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

Edit disconnecting(const char* relay) {
  Edit edit;
  edit.member = relay;
  edit.disconnect = {"out"};
  return edit;
}

Edit connecting(const char* relay, const char* service) {
  Edit edit;
  edit.member = relay;
  edit.connect = {{"out", service}};
  return edit;
}

TEST(Resource, CycleThatTwoEditsOfOneChangeCloseTogetherIsRefused) {
  Chain chain;
  Deployer deployer(chain, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Change change;
  change.edits = {connecting("first", "second.write"), connecting("second", "first.write")};

  const Result<Receipt> refused = deployer.apply(change);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::cycle);
  EXPECT_FALSE(chain.first.shell().out.connected());
}

TEST(Resource, CycleThatTheSameChangeOpensIsNone) {
  Chain chain;
  ASSERT_TRUE(chain.first.shell().out.connect(chain.second.interface().write));
  Deployer deployer(chain, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Change change;
  change.edits = {connecting("second", "first.write"), disconnecting("first")};

  EXPECT_TRUE(deployer.apply(change));
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

TEST(ResourceLock, IsAbandonedAfterTheBoundOfTheCaller) {
  ResourceLock lock;
  std::atomic<bool> held{false};
  std::atomic<bool> leave{false};
  std::thread holder([&] {
    ScopedLock scope(lock);
    held = true;
    while (!leave) std::this_thread::yield();
  });
  while (!held) std::this_thread::yield();
  this_job().lock_bound = 2ms;

  EXPECT_FALSE(lock.enter());
  EXPECT_EQ(lock.timeouts(), 1u);

  this_job().lock_bound = 0ms;
  leave = true;
  holder.join();
  EXPECT_TRUE(lock.enter());
  lock.leave();
}

TEST(ResourceLock, IsLeftWhenACoreThrows) {
  ResourceLock lock;
  try {
    ScopedLock scope(lock);
    throw 1;
  } catch (int) {
  }
  EXPECT_EQ(this_job().held_count, 0u);
  ASSERT_TRUE(lock.enter());
  lock.leave();
}

TEST(Tap, SeesEveryWriteAndCountsWhatItLost) {
  SharedDataBase data("data", data_type<double>());
  const auto shared = std::make_shared<Tap>(data_type<double>(), 3);
  Tap& tap = *shared;
  ServiceBase& write = data.write_service();
  ASSERT_TRUE(write.taps()->attach(shared, data.lock()));
  for (const double value : {1.0, 2.0, 3.0, 4.0}) write.write(&value);

  std::vector<double> seen;
  while (tap.pop(
      [&](const void* value, Instant) { seen.push_back(*static_cast<const double*>(value)); })) {
  }
  EXPECT_EQ(seen, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(tap.take_lost(), 1u);
  EXPECT_EQ(tap.take_lost(), 0u);
  write.taps()->detach(tap, data.lock());
  const double last = 5.0;
  write.write(&last);
  EXPECT_FALSE(tap.pop([](const void*, Instant) {}));
}

TEST(Tap, DetachesWhileAWriterHangsAndStaysWhereTheWriterMayLook) {
  SharedDataBase data("data", data_type<double>());
  TapList& list = *data.write_service().taps();
  auto tap = std::make_shared<Tap>(data_type<double>(), 3);
  ASSERT_TRUE(list.attach(tap, data.lock()));
  HangingWriter writer(data);
  this_job().lock_bound = 1ms;

  list.detach(*tap, data.lock());

  this_job().lock_bound = 0ms;
  const std::weak_ptr<Tap> left = tap;
  tap.reset();
  EXPECT_FALSE(left.expired());
  writer.let_go();
  EXPECT_FALSE(left.lock()->pop([](const void*, Instant) {})) << "a closed tap took a value";
  auto other = std::make_shared<Tap>(data_type<double>(), 3);
  ASSERT_TRUE(list.attach(other, data.lock()));
  EXPECT_TRUE(left.expired()) << "the next attach gives it up";
  list.detach(*other, data.lock());
}

TEST(Tap, OfAHangingWriterKeepsNoSlotForEver) {
  SharedDataBase data("data", data_type<double>());
  TapList& list = *data.write_service().taps();
  const auto make = [] { return std::make_shared<Tap>(data_type<double>(), 1); };
  std::vector<std::shared_ptr<Tap>> taps;
  for (std::size_t i = 0; i < TapList::kMaxTaps; ++i) {
    taps.push_back(make());
    ASSERT_TRUE(list.attach(taps.back(), data.lock()));
  }
  EXPECT_EQ(list.attach(make(), data.lock()).error().code, Errc::limit);
  HangingWriter writer(data);
  this_job().lock_bound = 1ms;
  for (const auto& tap : taps) list.detach(*tap, data.lock());
  EXPECT_EQ(list.attach(make(), data.lock()).error().code, Errc::timed_out);
  this_job().lock_bound = 0ms;
  writer.let_go();

  for (auto& tap : taps) EXPECT_TRUE(list.attach(tap = make(), data.lock()));
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

struct LargeValue {
  std::array<std::uint8_t, SharedDataBase::kLarge + 1> bytes{};
  static constexpr std::string_view type_name = "large/1";
  static constexpr auto fields() { return std::tuple{field("bytes", &LargeValue::bytes)}; }
};
TEST(SharedData, OfALargeValueServesMoreReadersThanItHasSlotsToo) {
  const auto value = std::make_unique<LargeValue>(LargeValue{{7}});
  SharedDataBase data("data", data_type<LargeValue>());
  data.write_service().write(value.get());
  for (unsigned reader = 0; reader < SharedDataBase::kReadersOfLarge + 2; ++reader) {
    Cursor cursor;
    cursor.slot = data.read_service().attach();
    *value = {};
    EXPECT_EQ(data.read_service().read(value.get(), cursor), DataStatus::new_data);
    EXPECT_EQ(value->bytes.front(), 7);
  }
}

TEST(SharedData, TakesNoValueByItsServiceWhileItIsPoisoned) {
  SharedDataBase data("data", data_type<double>());
  const double first = 7.0;
  ASSERT_TRUE(data.write_service().write(&first));
  data.lock().poison();
  const double second = 8.0;

  EXPECT_FALSE(data.write_service().write(&second));
  EXPECT_EQ(value_of(data), 7.0);

  data.lock().clear_poison();
  EXPECT_TRUE(data.write_service().write(&second));
  EXPECT_EQ(value_of(data), 8.0);
}

/// So many relays in a row, and `end` behind the last one.
struct Row : Architecture {
  explicit Row(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      relays.push_back(std::make_unique<Relay>(*this, "relay" + std::to_string(i)));
    }
    end = std::make_unique<SharedData<double>>(*this, "end");
  }
  Status on_configure() override {
    for (std::size_t i = 0; i < relays.size(); ++i) {
      ServiceBase& next =
          i + 1 < relays.size() ? relays[i + 1]->interface().write : end->write_service();
      if (Status done = relays[i]->shell().out.connect(next); !done) return done;
    }
    return ok();
  }
  std::vector<std::unique_ptr<Relay>> relays;
  std::unique_ptr<SharedData<double>> end;
};

TEST(Resource, NestAsDeepAsAThreadMayHoldAndNoDeeper) {
  Row deepest(Job::kMaxHeld - 1);
  Row deeper(Job::kMaxHeld);

  const Status done = deepest.configure();
  const Status refused = deeper.configure();

  ASSERT_TRUE(done) << to_string(done.error());
  const double one = 1.0;
  EXPECT_TRUE(deepest.relays[0]->interface().write.write(&one));
  EXPECT_EQ(value_of(*deepest.end), 128.0) << "the value came to the end: all could be held";
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::limit);
}

/// The same row, of which the last relay is listed first.
struct Backward : Architecture {
  explicit Backward(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      relays.push_back(std::make_unique<Relay>(*this, "relay" + std::to_string(i)));
    }
  }
  Status on_configure() override {
    for (std::size_t i = 1; i < relays.size(); ++i) {
      const Status done = relays[i]->shell().out.connect(relays[i - 1]->interface().write);
      if (!done) return done;
    }
    return ok();
  }
  std::vector<std::unique_ptr<Relay>> relays;
};

TEST(Resource, NestNoDeeperInWhateverOrderTheyAreListed) {
  Backward deepest(Job::kMaxHeld);
  Backward deeper(Job::kMaxHeld + 1);

  EXPECT_TRUE(deepest.configure());
  const Status refused = deeper.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::limit);
}

TEST(Resource, NestNoDeeperByAConnectionOfTheLastOne) {
  Backward row(Job::kMaxHeld);
  Relay behind{row, "behind"};
  Deployer deployer(row, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> refused = deployer.connect("relay0.ports.out", "behind.write");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::limit);
  EXPECT_TRUE(deployer.connect("behind.ports.out", "relay6.write")) << "eight in a row";
}

TEST(ResourceLock, LetsNoAbandonedThreadApplyAChange) {
  struct Waiting final : PendingUpdate {
    bool apply(Instant /*release*/) override { return ++visits, true; }
    int visits = 0;
  } change;
  ResourceLock lock;
  lock.defer(change);
  this_job().running = true;
  {
    const NoPorts no_ports;
    EXPECT_FALSE(lock.enter());
  }
  this_job().running = false;
  EXPECT_EQ(change.visits, 0);

  EXPECT_TRUE(lock.enter());
  lock.leave();
  EXPECT_EQ(change.visits, 1) << "the next caller takes it";
}

}  // namespace
}  // namespace mauve
