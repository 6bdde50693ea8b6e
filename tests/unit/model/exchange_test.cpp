// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ports that use the exchange inside a SharedData without a call.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "unit/model/shared_data_users.h"

#include <mauve/detail/exchange.h>
#include <mauve/detail/tap.h>

namespace mauve {
namespace {

TEST(SharedData, TheFirstWriterIsNotHeldUpByAnotherThatHangsInIt) {
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  EXPECT_TRUE(port.write(6.0));
  HangingWriter writer(data);

  EXPECT_TRUE(port.write(7.0));

  EXPECT_EQ(value_of(data), 7.0);
  EXPECT_EQ(data.lock().timeouts(), 0u);
  writer.let_go();
  EXPECT_EQ(value_of(data), 9.0);
}

TEST(SharedData, TheSecondWriterTakesTheLock) {
  SharedDataBase data("data", data_type<double>());
  Writer first(data);
  Writer second(data);
  EXPECT_TRUE(second.write(1.0));
  EXPECT_TRUE(first.write(2.0));
  EXPECT_TRUE(second.write(3.0));
  EXPECT_EQ(value_of(data), 3.0);
  HangingWriter hanging(data);
  this_job().lock_bound = 1ms;

  EXPECT_FALSE(second.write(4.0));

  this_job().lock_bound = 0ms;
  EXPECT_EQ(data.lock().timeouts(), 1u);
}

TEST(SharedData, TheNextWriterNeedsNoLockOnceTheFirstIsGone) {
  SharedDataBase data("data", data_type<double>());
  std::optional<Writer> first(data);
  EXPECT_TRUE(first->write(1.0));
  Writer second(data);
  EXPECT_TRUE(second.write(2.0));
  first.reset();
  EXPECT_TRUE(second.write(3.0));  // finds the place free
  HangingWriter hanging(data);

  EXPECT_TRUE(second.write(4.0));

  EXPECT_EQ(value_of(data), 4.0);
}

TEST(SharedData, TheSafeValueOfTheFirstWriterWaitsForNobody) {
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  EXPECT_TRUE(port.write(7.0));
  HangingWriter writer(data);

  port.write_safe(true);

  EXPECT_EQ(value_of(data), Writer::kSafe);
  EXPECT_EQ(data.lock().timeouts(), 0u);
}

TEST(SharedData, ASafeValueWaitsForNobodyAlsoWhileSomebodyListens) {
  SharedDataBase data("data", data_type<double>());
  const auto tap = std::make_shared<Tap>(data_type<double>(), 4);
  ASSERT_TRUE(data.write_service().taps()->attach(tap, data.lock()));
  Writer port(data);
  data.lock().poison();

  port.write_safe(true);

  EXPECT_EQ(value_of(data), Writer::kSafe);
}

TEST(SharedData, AThreadThatIsAbandonedWhileItWaitsForTheLockWritesNothing) {
  SharedDataBase data("data", data_type<double>());
  HangingWriter hanging(data);
  std::atomic<Job*> job{nullptr};
  std::thread waiting([&] {
    this_job().running = true;
    job = &this_job();
    const double late = 7.0;
    EXPECT_FALSE(data.write_service().write(&late));
  });
  while (job == nullptr) std::this_thread::yield();
  job.load()->no_ports = true;
  hanging.let_go();
  waiting.join();
  EXPECT_EQ(value_of(data), 9.0);
}

TEST(SharedData, AnAbandonedThreadWritesNothingMoreAndLeavesItsSlotToItsSuccessor) {
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  EXPECT_TRUE(port.write(1.0));
  this_job().no_ports = true;
  EXPECT_FALSE(port.write(2.0));
  EXPECT_EQ(value_of(data), 1.0);
  this_job().no_ports = false;
  HangingWriter hanging(data);

  EXPECT_TRUE(port.write(3.0)) << "needs no lock";

  EXPECT_EQ(value_of(data), 3.0);
}

TEST(SharedData, AThreadThatIsAbandonedWhileItFillsAValueIsNotSeen) {
  SharedDataBase data("data", data_type<double>());
  this_job().running = true;
  auto filler = [](void* value) {
    *static_cast<double*>(value) = 9.0;
    this_job().no_ports = true;
  };

  EXPECT_FALSE(data.write_service().fill(Filler(filler)));

  this_job().no_ports = false;
  this_job().running = false;
  EXPECT_EQ(value_of(data), -1.0);
}

/// As after a change was rolled back: the connection is the same, another shell used it meanwhile.
struct AShellThatComesBack : testing::Test {
  struct ReaderShell : Shell {
    ReadPort<double> in{*this, "in"};
  };

  void SetUp() override {
    ASSERT_TRUE(before.in.connect(data.read_service()));
    table = std::move(before.initial_bindings());
  }

  SharedDataBase data{"data", data_type<double>()};
  Writer port{data};
  ReaderShell before;
  ReaderShell after;
  Bindings table;
};

TEST_F(AShellThatComesBack, ReadsTheNewestValue) {
  this_job().start = 1;
  before.use(&table);
  EXPECT_TRUE(port.write(1.0));
  EXPECT_EQ(before.in.read(), 1.0);
  EXPECT_EQ(before.in.read(), 1.0);
  after.use(&table);
  EXPECT_TRUE(port.write(2.0));
  this_job().start = 1;
  EXPECT_EQ(after.in.read(), 2.0);
  before.use(&table);

  EXPECT_EQ(before.in.read(), 2.0);
  EXPECT_EQ(before.in.read(), 2.0);

  this_job().start = 0;
}

/// The word of the exchange may be the same again, with another value.
TEST_F(AShellThatComesBack, SeesWhatIsNewAlsoInTheSameSlot) {
  double written = 0;
  for (int writes = 1; writes <= 6; ++writes) {
    before.use(&table);
    EXPECT_TRUE(port.write(++written));
    EXPECT_EQ(before.in.read(), written);
    EXPECT_EQ(before.in.read(), written) << "at hand";
    after.use(&table);
    for (int i = 0; i < writes; ++i) {
      EXPECT_TRUE(port.write(++written));
      EXPECT_EQ(after.in.read(), written);
    }

    before.use(&table);

    EXPECT_EQ(before.in.read(), written);
    EXPECT_EQ(before.in.status(), DataStatus::new_data) << writes;
    EXPECT_EQ(before.in.read(), written);
    EXPECT_EQ(before.in.status(), DataStatus::old_data);
  }
}

TEST(Tap, GetsAValueThatWasBeingWrittenWhenItWasAttached) {
  SharedDataBase data("data", data_type<double>());
  Exchange& exchange = *data.write_service().exchange();
  const Binding binding(data.write_service(), nullptr, Duration{0});
  const double value = 7.0;
  ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 1));
  const auto tap = std::make_shared<Tap>(data_type<double>(), 1);
  ASSERT_TRUE(exchange.taps.attach(tap, data.lock()));

  EXPECT_TRUE(binding.notify_taps(&value, 1));

  EXPECT_TRUE(tap->pop([](const void* seen, Instant stamp) {
    EXPECT_EQ(*static_cast<const double*>(seen), 7.0);
    EXPECT_EQ(stamp, 1);
  }));
}

TEST(SharedData, TheFirstWriterGoesOnWhileItIsPoisoned) {
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  EXPECT_TRUE(port.write(1.0));
  data.lock().poison();
  EXPECT_TRUE(port.write(2.0));
  EXPECT_EQ(value_of(data), 2.0);
}

class Look : public testing::Test {
 protected:
  struct ReaderShell : Shell {
    ReadPort<double> in{*this, "in"};
  };
  void SetUp() override {
    ASSERT_TRUE(shell_.in.connect(data_.read_service()));
    table_ = std::move(shell_.initial_bindings());
    shell_.use(&table_);
  }

  SharedDataBase data_{"data", data_type<double>()};
  Writer writer_{data_};
  ReaderShell shell_;
  ReadPort<double>& in_ = shell_.in;

 private:
  Bindings table_;
};

TEST_F(Look, ShowsAValueAgainToWhoThrew) {
  EXPECT_TRUE(writer_.write(1.0));
  EXPECT_THROW(in_.look([](double) { throw std::runtime_error("no"); }), std::runtime_error);

  EXPECT_EQ(in_.look([](double) {}), DataStatus::new_data);

  EXPECT_EQ(in_.look([](double) {}), DataStatus::old_data);
}

TEST_F(Look, KnowsTheAgeOfWhatItShows) {
  EXPECT_TRUE(writer_.write(1.0));  // at 1
  this_job().start = 11;

  const auto shown = in_.look([this](double) { EXPECT_EQ(in_.age(), 10ns); });

  this_job().start = 0;
  EXPECT_EQ(shown, DataStatus::new_data);
}

TEST_F(Look, MayReadOnWhileItShows) {
  EXPECT_TRUE(writer_.write(1.0));
  const auto shown = in_.look([this](double) {
    EXPECT_TRUE(writer_.write(2.0));
    EXPECT_EQ(in_.read(), 2.0);
  });
  EXPECT_EQ(shown, DataStatus::new_data);
  EXPECT_TRUE(writer_.write(3.0));
  EXPECT_EQ(in_.read(), 3.0);
  EXPECT_EQ(in_.read(), 3.0);
}

/// The other thread is the successor of one that was abandoned in its visitor.
TEST_F(Look, ChangesNothingOnceItsThreadIsAbandoned) {
  EXPECT_TRUE(writer_.write(1.0));
  in_.look([this](double) {
    std::thread([this] {
      EXPECT_TRUE(writer_.write(2.0));
      EXPECT_EQ(in_.read(), 2.0);
      EXPECT_TRUE(writer_.write(3.0));
      EXPECT_EQ(in_.read(), 3.0);
    }).join();
    this_job().no_ports = true;
  });
  this_job().no_ports = false;

  EXPECT_EQ(in_.look([](double value) { EXPECT_EQ(value, 3.0); }), DataStatus::old_data);
}

/// Writes from another thread, which gives up when the lock is held.
bool written_by_another(ServiceBase& service, double value) {
  bool written = false;
  std::thread([&] {
    this_job().lock_bound = 1ms;
    written = service.write(&value);
  }).join();
  return written;
}

struct OneReader : Shell {
  explicit OneReader(ServiceBase& service) {
    EXPECT_TRUE(in.connect(service));
    table = std::move(initial_bindings());
    use(&table);
  }
  ReadPort<double> in{*this, "in"};
  Bindings table;
};

TEST(LookAtAQueue, KeepsNobodyFromWriting) {
  RingBufferBase queue("queue", data_type<double>());
  ASSERT_TRUE(queue.configure());
  OneReader reader(queue.read_service());
  ASSERT_TRUE(written_by_another(queue.write_service(), 1.0));

  const DataStatus status = reader.in.look([&](double shown) {
    EXPECT_TRUE(written_by_another(queue.write_service(), 2.0));
    EXPECT_EQ(shown, 1.0);
  });

  EXPECT_EQ(status, DataStatus::new_data);
  EXPECT_EQ(reader.in.read(), 2.0);
  EXPECT_EQ(queue.lock().timeouts(), 0u);
}

TEST(LookWithoutASlot, KeepsNobodyFromWriting) {
  SharedDataBase data("data", data_type<double>());
  Writer first(data);
  std::vector<std::unique_ptr<OneReader>> readers;  // more than there are places
  for (unsigned i = 0; i < 32; ++i) {
    readers.push_back(std::make_unique<OneReader>(data.read_service()));
  }
  ReadPort<double>& last = readers.back()->in;
  ASSERT_TRUE(written_by_another(data.write_service(), 1.0));

  const DataStatus status = last.look([&](double shown) {
    EXPECT_TRUE(written_by_another(data.write_service(), 2.0));
    EXPECT_EQ(shown, 1.0);
  });

  EXPECT_EQ(status, DataStatus::new_data);
  EXPECT_EQ(last.read(), 2.0);
  EXPECT_EQ(data.lock().timeouts(), 0u);
}

/// A tap gets every value that cannot be read yet when it is attached.
TEST(Tap, MissesNothingOfAWriterThatTakesNoLock) {
  constexpr int kTimes = 2000;
  SharedDataBase data("data", data_type<double>());
  TapList& list = *data.write_service().taps();
  std::atomic<int> round{0};
  std::atomic<int> written{0};
  std::thread writer([&] {
    Writer port(data);
    for (int i = 1; i <= kTimes; ++i) {
      while (round < i) std::this_thread::yield();
      EXPECT_TRUE(port.write(i));
      written = i;
    }
  });
  int missed = 0;
  for (int i = 1; i <= kTimes; ++i) {
    const auto tap = std::make_shared<Tap>(data_type<double>(), 4);
    round = i;
    EXPECT_TRUE(list.attach(tap, data.lock()));
    const bool was_there = value_of(data) == i;
    while (written < i) std::this_thread::yield();
    const bool tapped = tap->pop([](const void*, Instant) {});
    missed += was_there || tapped ? 0 : 1;
    list.detach(*tap, data.lock());
  }
  writer.join();
  EXPECT_EQ(missed, 0);
}

}  // namespace
}  // namespace mauve
