// SPDX-License-Identifier: LGPL-3.0-or-later
/// The wait-free exchange inside a SharedData.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "support/eventually.h"

#include <mauve/detail/latest_value.h>

namespace mauve {
namespace {

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

/// Writes as ports do.
void write_somehow(LatestValue& exchange, std::uint64_t number) {
  const auto may = [] { return true; };
  const Numbered value = numbered(number);
  if (exchange.write_as_expected(&value, sizeof value, 0, may)) return;
  ASSERT_TRUE(exchange.write_alone(&value, sizeof value, 0, may));
}

class LatestValueRead : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(By, LatestValueRead, testing::Values(1, 3));

TEST_P(LatestValueRead, NeverShowsATornOrAnOlderValueOfEitherWriter) {
  LatestValue exchange(sizeof(Numbered), 4);
  std::atomic<bool> done{false};
  std::vector<std::thread> threads;
  std::atomic<int> faults{0};
  std::atomic<int> readers{0};  // that have read a value
  for (int i = 0; i < GetParam(); ++i) {
    threads.emplace_back([&, cursor = Cursor{exchange.attach()}]() mutable {
      std::array<std::uint64_t, 2> last{};  // odd and even numbers come from two writers
      bool reads = false;
      while (!done) {
        if (exchange.seek(cursor) == DataStatus::no_data) continue;
        if (!std::exchange(reads, true)) ++readers;
        const std::uint64_t number = number_of(cursor.data);
        faults += number == 0 || number < last[number % 2] ? 1 : 0;
        last[number % 2] = number;
      }
    });
  }
  threads.emplace_back([&] {
    for (std::uint64_t n = 2; !done; n += 2) write_in_turn(exchange, numbered(n));
  });
  EXPECT_TRUE(test::eventually([&] { return readers == GetParam(); }));
  for (std::uint64_t n = 1; n < 100'000; n += 2) {
    write_somehow(exchange, n);
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

TEST(LatestValue, AThreadThatIsAbandonedWhileItPublishesOvertakesNobody) {
  LatestValue exchange(sizeof(Numbered), 2);
  const unsigned slot = exchange.attach();
  const Numbered lost = numbered(1);
  int asked = 0;
  const auto abandoned = [&] {
    if (++asked == 2) write_in_turn(exchange, numbered(2));
    return asked <= 2;
  };

  EXPECT_FALSE(exchange.write_alone(&lost, sizeof lost, 0, abandoned));

  EXPECT_EQ(number_of(exchange.acquire(slot).data), 2u);
}

/// A reader that was abandoned and its successor have the same slot.
TEST(LatestValue, IsHeldStillAlsoWhenTwoThreadsTakeItForTheSameReader) {
  constexpr int kRounds = 20'000;
  LatestValue exchange(sizeof(Numbered), 1);
  const unsigned reader = exchange.attach();
  std::atomic<int> round{0};
  std::array<std::atomic<const void*>, 2> held{};
  std::atomic<int> took{0};
  std::vector<std::thread> threads;
  for (auto& its : held) {
    threads.emplace_back([&] {
      for (int i = 1; i <= kRounds; ++i) {
        for (int spins = 0; round < i; ++spins) {
          if (spins > 1000) std::this_thread::yield();
        }
        its = exchange.acquire(reader).data;
        ++took;
      }
    });
  }
  int faults = 0;
  for (int i = 1; i <= kRounds; ++i) {
    const auto first = static_cast<std::uint64_t>(4 * i);
    for (std::uint64_t number = first; number < first + 4; ++number) {
      const Numbered value = numbered(number);
      EXPECT_TRUE(exchange.write_alone(&value, sizeof value, 0, [] { return true; }));
      if (number > first) continue;
      for (round = i; took < 2 * i;) std::this_thread::yield();
    }
    for (const auto& its : held) faults += number_of(its) == first ? 0 : 1;
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(faults, 0);
}

TEST(LatestValue, IsTheTripleBufferButForAValueThatAnotherReaderTakes) {
  const auto may = [] { return true; };
  const Numbered value = numbered(1);
  LatestValue exchange(sizeof value, 2);
  const unsigned first = exchange.attach();
  const unsigned second = exchange.attach();
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(exchange.write_as_expected(&value, sizeof value, 0, may));
    static_cast<void>(exchange.acquire(first));
  }
  static_cast<void>(exchange.acquire(second));
  EXPECT_FALSE(exchange.write_as_expected(&value, sizeof value, 0, may));
  EXPECT_TRUE(exchange.write_alone(&value, sizeof value, 0, may));
  for (int i = 0; i < 3; ++i) {
    static_cast<void>(exchange.acquire(first));
    if (exchange.write_as_expected(&value, sizeof value, 0, may)) continue;
    EXPECT_TRUE(exchange.write_alone(&value, sizeof value, 0, may));
  }
  static_cast<void>(exchange.acquire(first));
  EXPECT_TRUE(exchange.write_as_expected(&value, sizeof value, 0, may));
}

/// Any order of writes and reads of three readers, two of which may come later.
TEST(LatestValue, HoldsAValueStillInWhateverOrderItIsReadAndWritten) {
  std::mt19937 random(1);
  for (int round = 0; round < 500; ++round) {
    LatestValue exchange(sizeof(Numbered), 3);
    std::array<unsigned, 3> slots{};
    for (unsigned& slot : slots) slot = exchange.attach();
    const std::size_t readers = 1 + random() % 3;
    std::array<LatestValue::View, 3> views{};
    std::array<std::uint64_t, 3> numbers{};
    std::uint64_t number = 0;
    for (int step = 0; step < 200; ++step) {
      const auto what = random() % 6;
      if (what < 2) write_somehow(exchange, ++number);
      if (what == 2 && random() % 8 == 0) write_in_turn(exchange, numbered(++number));
      const std::size_t reader = step < 100 ? 0 : random() % readers;
      if (what > 2) {
        views[reader] = exchange.acquire(slots[reader]);
        numbers[reader] = number;
      }
      for (std::size_t i = 0; i < readers; ++i) {
        if (views[i].data == nullptr) continue;
        ASSERT_EQ(number_of(views[i].data), numbers[i]);
      }
    }
  }
}

TEST(LatestValue, IsWrittenUnderTheLockForEverOnceAThreadWasLostInIt) {
  LatestValue exchange(sizeof(Numbered), 2);
  const unsigned slot = exchange.attach();
  const Numbered value = numbered(1);
  EXPECT_FALSE(exchange.write_as_expected(&value, sizeof value, 0, [] { return false; }));
  EXPECT_FALSE(exchange.write_as_expected(&value, sizeof value, 0, [] { return true; }));
  EXPECT_FALSE(exchange.write_alone(&value, sizeof value, 0, [] { return true; }));
  EXPECT_EQ(exchange.acquire(slot).data, nullptr);

  write_in_turn(exchange, value);

  EXPECT_EQ(number_of(exchange.acquire(slot).data), 1u);
}

TEST(LatestValue, LetsNobodyInWhoComesLate) {
  LatestValue exchange(sizeof(Numbered), 2);
  const Numbered value = numbered(1);
  EXPECT_FALSE(exchange.write_alone(&value, sizeof value, 0, [] { return false; }));

  EXPECT_TRUE(exchange.write_alone(&value, sizeof value, 0, [] { return true; }));
}

TEST(LatestValue, ServesThoseInTurnAlsoWithoutAnyOtherReader) {
  LatestValue exchange(sizeof(Numbered), 0);
  EXPECT_EQ(exchange.attach(), LatestValue::kNoSlot);
  for (std::uint64_t number = 1; number < 10; ++number) {
    write_somehow(exchange, number);
    EXPECT_EQ(number_of(exchange.acquire(LatestValue::kInTurn).data), number);
  }
}

TEST(LatestValue, HasOneSlotForAWriter) {
  LatestValue exchange(sizeof(Numbered), 2);
  EXPECT_TRUE(exchange.claim_slot(1));
  EXPECT_TRUE(exchange.claim_slot(1));
  EXPECT_FALSE(exchange.claim_slot(2));
  exchange.release_slot(2);
  EXPECT_FALSE(exchange.claim_slot(2));
  exchange.release_slot(1);
  EXPECT_TRUE(exchange.claim_slot(2));
}

TEST(LatestValue, ReportsToACursorWhetherItsValueIsNew) {
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

/// A thread lost before it took a value takes it while its successor stands at an older one.
TEST(LatestValue, ACursorGoesOnWithTheNewestValueThatALostThreadTookForTheSameReader) {
  LatestValue exchange(sizeof(Numbered), 2);
  Cursor cursor{exchange.attach()};
  write_somehow(exchange, 1);
  EXPECT_EQ(exchange.seek(cursor), DataStatus::new_data);
  write_somehow(exchange, 2);
  static_cast<void>(exchange.acquire(cursor.slot));  // the lost one: 1 is given back

  EXPECT_EQ(exchange.seek(cursor), DataStatus::new_data);

  for (std::uint64_t number = 3; number < 10; ++number) {
    EXPECT_EQ(number_of(cursor.data), number - 1);
    EXPECT_EQ(exchange.seek(cursor), DataStatus::old_data);
    write_somehow(exchange, number);
    EXPECT_EQ(number_of(cursor.data), number - 1) << "held still";
    EXPECT_EQ(exchange.seek(cursor), DataStatus::new_data);
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
