// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/ring/trace_ring.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace mauve::rt {
namespace {

struct Drained {
  std::vector<TraceEntry> entries;
  std::uint64_t lost = 0;
};

Drained drain(TraceRing& ring) {
  Drained all;
  ring.drain([&](const TraceEntry& entry) { all.entries.push_back(entry); },
             [&](std::uint64_t lost) { all.lost += lost; });
  return all;
}

TEST(TraceRing, GivesEveryPartOfARecordBack) {
  TraceRing ring;
  ring.push(TraceKind::lock, 123, 0xabcdef, 77, -5);

  const Drained all = drain(ring);

  ASSERT_EQ(all.entries.size(), 1u);
  EXPECT_EQ(all.entries[0].time, 123);
  EXPECT_EQ(all.entries[0].kind, TraceKind::lock);
  EXPECT_EQ(all.entries[0].name, 0xabcdefu);
  EXPECT_EQ(all.entries[0].small, 77u);
  EXPECT_EQ(all.entries[0].value, -5);
  EXPECT_EQ(all.lost, 0u);
  EXPECT_TRUE(drain(ring).entries.empty()) << "what was collected is not given again";
}

TEST(TraceRing, AnArgumentThatIsTooLargeBecomesTheLargest) {
  TraceRing ring;
  ring.push(TraceKind::budget, 1, 0, ~0ULL, 0);

  EXPECT_EQ(drain(ring).entries.at(0).small, 0xffffffffu);
}

TEST(TraceRing, TimeNeverGoesBack) {
  TraceRing ring;
  ring.push(TraceKind::begin, 100, 0, 0, 0);
  ring.push(TraceKind::end, 90, 0, 0, 0);

  EXPECT_EQ(drain(ring).entries.at(1).time, 100);
}

TEST(TraceRing, CountsWhatWasOverwrittenBeforeAnybodyCame) {
  TraceRing ring;
  constexpr std::int64_t kPushed = 5000;
  for (std::int64_t i = 0; i < kPushed; ++i) ring.push(TraceKind::user, i, 0, 0, i);

  const Drained all = drain(ring);

  EXPECT_EQ(all.entries.size() + all.lost, static_cast<std::uint64_t>(kPushed));
  EXPECT_GE(all.entries.size(), TraceRing::kCapacity - 1);
  EXPECT_EQ(all.entries.back().value, kPushed - 1) << "the newest stay";
  EXPECT_EQ(all.entries.front().value, static_cast<std::int64_t>(all.lost)) << "the oldest go";
}

TEST(TraceRing, OnASimulatedClockItsTimeIsThatOfTheClock) {
  const ManualClock clock(5000);
  const TraceRing ring(&clock);

  EXPECT_EQ(ring.now(), 5000);
  EXPECT_EQ(ring.now(99), 5000) << "a reading of the machine is no time here";
  EXPECT_EQ(TraceRing().now(99), 99);
}

/// Each record carries its number in all its parts.
TEST(TraceRing, WhoReadsWhileItIsWrittenSeesNoHalfRecordAndCountsTheRest) {
  TraceRing ring;
  constexpr std::int64_t kPushed = 400'000;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::int64_t i = 0; i < kPushed; ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      ring.push(TraceKind::user, i, number & 0xffffff, number, i);
    }
    done = true;
  });

  std::int64_t next = 0;
  std::uint64_t torn = 0;
  std::uint64_t out_of_order = 0;
  const auto look = [&] {
    ring.drain(
        [&](const TraceEntry& entry) {
          const auto number = static_cast<std::uint32_t>(entry.value);
          const bool whole = entry.time == entry.value && entry.small == number &&
                             entry.name == (number & 0xffffff);
          torn += whole ? 0 : 1;
          out_of_order += entry.value == next ? 0 : 1;
          next = entry.value + 1;
        },
        [&](std::uint64_t lost) { next += static_cast<std::int64_t>(lost); });
  };
  while (!done) look();
  writer.join();
  look();

  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(out_of_order, 0u) << "what is missing is counted";
  EXPECT_EQ(next, kPushed);
}

}  // namespace
}  // namespace mauve::rt
