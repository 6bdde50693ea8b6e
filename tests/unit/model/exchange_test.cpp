// SPDX-License-Identifier: LGPL-3.0-or-later
/// The wait-free exchange inside a SharedData, and the ports that use it without a call.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <thread>
#include <vector>

#include "unit/model/shared_data_users.h"

#include <mauve/exchange.h>
#include <mauve/tap.h>

namespace mauve {
namespace {

TEST(SharedData, TheFirstWriterIsNotHeldUpByAnotherThatHangsInIt) {
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  EXPECT_TRUE(port.write(6.0));
  HangingWriter writer(data);

  EXPECT_TRUE(port.write(7.0));

  EXPECT_EQ(value_of(data), 7.0);
  EXPECT_EQ(data.gate().timeouts(), 0u);
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
  EXPECT_EQ(data.gate().timeouts(), 1u);
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
  EXPECT_EQ(data.gate().timeouts(), 0u);
}

TEST(SharedData, ASafeValueWaitsForNobodyAlsoWhileSomebodyListens) {
  SharedDataBase data("data", data_type<double>());
  const auto tap = std::make_shared<Tap>(data_type<double>(), 4);
  ASSERT_TRUE(data.write_service().taps()->attach(tap, data.gate()));
  Writer port(data);
  data.gate().poison();

  port.write_safe(true);

  EXPECT_EQ(value_of(data), Writer::kSafe);
}

TEST(SharedData, WhoIsGivenUpWhileHeWaitsForTheLockWritesNothing) {
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
  job.load()->detached = true;
  hanging.let_go();
  waiting.join();
  EXPECT_EQ(value_of(data), 9.0);
}

TEST(SharedData, WhoWasGivenUpWritesNothingMore) {
  SharedDataBase data("data", data_type<double>());
  Exchange& exchange = *data.write_service().exchange();
  const double value = 7.0;
  this_job().detached = true;
  EXPECT_FALSE(exchange.write_alone(&value, sizeof value, 1));
  this_job().detached = false;

  EXPECT_FALSE(exchange.write_alone(&value, sizeof value, 1)) << "the first may still be inside";

  EXPECT_EQ(value_of(data), -1.0);
}

/// As after a change was rolled back: the connection is the same, another shell used it meanwhile.
TEST(SharedData, AShellThatComesBackReadsTheNewestValue) {
  struct ReaderShell : Shell {
    ReadPort<double> in{*this, "in"};
  };
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  ReaderShell before;
  ReaderShell after;
  ASSERT_TRUE(before.in.connect(data.read_service()));
  const Bindings table = std::move(before.initial_bindings());
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

TEST(Tap, IsToldAValueThatWasOnItsWayWhenItCame) {
  SharedDataBase data("data", data_type<double>());
  Exchange& exchange = *data.write_service().exchange();
  const Binding binding(data.write_service(), nullptr, Duration{0});
  const double value = 7.0;
  ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 1));
  const auto tap = std::make_shared<Tap>(data_type<double>(), 1);
  ASSERT_TRUE(exchange.taps.attach(tap, data.gate()));

  EXPECT_TRUE(binding.told(&value, 1));

  EXPECT_TRUE(tap->pop([](const void* told, Instant stamp) {
    EXPECT_EQ(*static_cast<const double*>(told), 7.0);
    EXPECT_EQ(stamp, 1);
  }));
}

TEST(SharedData, TheFirstWriterGoesOnWhileItIsPoisoned) {
  SharedDataBase data("data", data_type<double>());
  Writer port(data);
  EXPECT_TRUE(port.write(1.0));
  data.gate().poison();
  EXPECT_TRUE(port.write(2.0));
  EXPECT_EQ(value_of(data), 2.0);
}

/// What is not yet to be read when somebody begins to listen is told to him.
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
void write_in_turn(LatestValue& exchange, const Numbered& value) {
  std::memcpy(exchange.begin_write(), &value, sizeof value);
  exchange.end_write(0);
}

TEST(LatestValue, NeverShowsATornOrAnOlderValueOfEitherWriter) {
  LatestValue exchange(sizeof(Numbered), 4);
  std::atomic<bool> done{false};
  std::vector<std::thread> threads;
  std::atomic<int> faults{0};
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&, cursor = Cursor{exchange.attach()}]() mutable {
      std::array<std::uint64_t, 2> last{};  // odd and even numbers come from two writers
      while (!done) {
        if (exchange.seek(cursor) == DataStatus::no_data) continue;
        const std::uint64_t number = number_of(cursor.data);
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
    EXPECT_TRUE(exchange.write_alone(&value, sizeof value, 0, [] { return true; }));
  }
  done = true;
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(faults, 0);
}

TEST(LatestValue, HoldsAValueStillForEachReaderWhileBothWritersGoOn) {
  LatestValue exchange(sizeof(Numbered), LatestValue::kMaxReaders);
  std::vector<const void*> held;
  std::uint64_t number = 0;
  const auto write_some = [&] {
    for (int i = 0; i < 5; ++i) {
      const Numbered value = numbered(++number);
      ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 0, [] { return true; }));
      write_in_turn(exchange, numbered(++number));
    }
  };
  for (unsigned reader = 0; reader < LatestValue::kMaxReaders; ++reader) {
    write_some();
    held.push_back(exchange.acquire(exchange.attach()).data);
  }
  for (int i = 0; i < 10; ++i) write_some();
  for (std::size_t i = 0; i < held.size(); ++i) EXPECT_EQ(number_of(held[i]), 10 * (i + 1));
}

TEST(LatestValue, IsTheSameUntilItIsWrittenAgain) {
  LatestValue exchange(sizeof(Numbered), 2);
  const unsigned slot = exchange.attach();
  EXPECT_EQ(exchange.acquire(slot).data, nullptr);
  const Numbered value = numbered(1);
  ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 7, [] { return true; }));
  const auto first = exchange.acquire(slot);
  EXPECT_EQ(first.header.stamp, 7);
  EXPECT_EQ(exchange.acquire(slot).header.sequence, first.header.sequence);
  ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 8, [] { return true; }));
  EXPECT_NE(exchange.acquire(slot).header.sequence, first.header.sequence);
}

TEST(LatestValue, NeverShowsAValueThatAnotherWriterOvertook) {
  LatestValue exchange(sizeof(Numbered), 2);
  const unsigned slot = exchange.attach();
  const Numbered slow = numbered(1);
  const auto overtaken = [&] {
    write_in_turn(exchange, numbered(2));
    return true;
  };

  EXPECT_TRUE(exchange.write_alone(&slow, sizeof slow, 0, overtaken));

  EXPECT_EQ(number_of(exchange.acquire(slot).data), 2u);
  const Numbered next = numbered(3);
  EXPECT_TRUE(exchange.write_alone(&next, sizeof next, 0, [] { return true; }));
  EXPECT_EQ(number_of(exchange.acquire(slot).data), 3u);
}

TEST(LatestValue, IsWrittenUnderTheLockForEverOnceAThreadWasLostInIt) {
  LatestValue exchange(sizeof(Numbered), 2);
  const unsigned slot = exchange.attach();
  const Numbered value = numbered(1);
  EXPECT_FALSE(exchange.write_alone(&value, sizeof value, 0, [] { return false; }));
  EXPECT_FALSE(exchange.write_alone(&value, sizeof value, 0, [] { return true; }));
  EXPECT_EQ(exchange.acquire(slot).data, nullptr);

  write_in_turn(exchange, value);

  EXPECT_EQ(number_of(exchange.acquire(slot).data), 1u);
}

TEST(LatestValue, HasOnePlaceForAWriter) {
  LatestValue exchange(sizeof(Numbered), 2);
  EXPECT_TRUE(exchange.take_place(1));
  EXPECT_TRUE(exchange.take_place(1));
  EXPECT_FALSE(exchange.take_place(2));
  exchange.leave_place(2);
  EXPECT_FALSE(exchange.take_place(2));
  exchange.leave_place(1);
  EXPECT_TRUE(exchange.take_place(2));
}

TEST(LatestValue, TellsACursorWhetherItsValueIsNew) {
  LatestValue exchange(sizeof(Numbered), 2);
  Cursor cursor{exchange.attach()};
  EXPECT_EQ(exchange.seek(cursor), DataStatus::no_data);
  for (std::uint64_t number = 1; number < 5; ++number) {
    const Numbered value = numbered(number);
    ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 10, [] { return true; }));
    EXPECT_EQ(exchange.seek(cursor), DataStatus::new_data);
    EXPECT_EQ(exchange.seek(cursor), DataStatus::old_data);
    EXPECT_EQ(number_of(cursor.data), number);
    EXPECT_EQ(cursor.stamp, 10);
  }
}

/// Small values lie close together.
template <std::size_t Size>
void keeps_values_apart() {
  LatestValue exchange(Size, LatestValue::kMaxReaders);
  std::vector<Cursor> cursors;
  for (unsigned i = 0; i < LatestValue::kMaxReaders; ++i) {
    std::array<std::uint8_t, Size> value{};
    value.fill(static_cast<std::uint8_t>(i + 1));
    ASSERT_TRUE(exchange.write_alone(&value, Size, 0, [] { return true; }));
    cursors.push_back(Cursor{exchange.attach()});
    EXPECT_EQ(exchange.seek(cursors.back()), DataStatus::new_data);
  }
  for (unsigned i = 0; i < LatestValue::kMaxReaders; ++i) {
    std::array<std::uint8_t, Size> seen{};
    std::memcpy(&seen, cursors[i].data, Size);
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [&](int byte) { return byte == int(i) + 1; }))
        << Size;
    EXPECT_EQ(
        reinterpret_cast<std::uintptr_t>(cursors[i].data) % std::min<std::size_t>(16, Size & -Size),
        0u);
  }
}

TEST(LatestValue, KeepsValuesOfEverySizeApart) {
  keeps_values_apart<1>();
  keeps_values_apart<10>();
  keeps_values_apart<16>();
  keeps_values_apart<100>();
  keeps_values_apart<112>();
  keeps_values_apart<113>();
  keeps_values_apart<1000>();
}

}  // namespace
}  // namespace mauve
