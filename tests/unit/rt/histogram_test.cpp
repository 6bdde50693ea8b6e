// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/time/histogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <thread>
#include <vector>

namespace mauve::rt {
namespace {

constexpr std::int64_t kLongest = (1LL << Histogram::kEnd) - 1;

TEST(Histogram, HasABucketForEveryTime) {
  for (std::size_t i = 0; i < Histogram::kBuckets; ++i) {
    const std::uint64_t low = Histogram::lower(i);
    const std::uint64_t end = Histogram::lower(i + 1);
    EXPECT_EQ(Histogram::index_of(low), i);
    EXPECT_EQ(Histogram::index_of(end - 1), i);
    EXPECT_LE(static_cast<double>(end - low), std::max(4.0, static_cast<double>(low) / 16));
  }
  EXPECT_EQ(Histogram::lower(Histogram::kBuckets), 1ULL << Histogram::kEnd);
  EXPECT_EQ(Histogram::index_of(~0ULL), Histogram::kBuckets - 1) << "what is longer is in the last";
}

TEST(Histogram, FitsIntoTwoKilobytes) { EXPECT_LE(sizeof(Histogram), 2048U); }

TEST(Histogram, IsEmptyAtFirst) {
  const Distribution none = Histogram().look();

  EXPECT_EQ(none.count, 0U);
  EXPECT_EQ(none.max, Duration{0});
  EXPECT_EQ(none.mean(), Duration{0});
  EXPECT_EQ(none.percentile(50), Duration{0});
}

TEST(Histogram, KnowsCountSumAndExtremesExactly) {
  Histogram times;
  for (const std::int64_t time : {30, 70'001, 999, -5}) times.add(time);

  const Distribution seen = times.look();

  EXPECT_EQ(seen.count, 4U);
  EXPECT_EQ(seen.sum, Duration{71'030});
  EXPECT_EQ(seen.min, Duration{0}) << "less than nothing is nothing";
  EXPECT_EQ(seen.max, Duration{70'001});
  EXPECT_EQ(seen.percentile(100), Duration{70'001});
  times.clear();
  EXPECT_EQ(times.look().count, 0U);
  EXPECT_TRUE(times.look().buckets.empty());
}

TEST(Histogram, ReportsOneTimeExactlyAtEveryPercentile) {
  Histogram times;
  for (int i = 0; i < 1000; ++i) times.add(12'345);

  for (const double percent : {0.0, 1.0, 50.0, 99.9, 100.0}) {
    EXPECT_EQ(times.look().percentile(percent), Duration{12'345}) << percent;
  }
}

TEST(Histogram, KeepsWhatIsLongerThanItsLastBucket) {
  Histogram times;
  times.add(kLongest);
  times.add(1'000'000'000'000);

  EXPECT_EQ(times.look().max, Duration{1'000'000'000'000});
  EXPECT_EQ(times.look().buckets.size(), 1U);
}

struct Source {
  const char* name;
  std::function<double(std::mt19937_64&)> draw;
};

TEST(Histogram, ReportsPercentilesWithinItsErrorOfTheExactOnes) {
  const std::vector<Source> sources = {
      {"uniform", std::uniform_real_distribution<double>(0, 2e6)},
      {"short", std::uniform_real_distribution<double>(0, 200)},
      {"tail", std::lognormal_distribution<double>(8, 2)},
      {"two humps",
       [](std::mt19937_64& random) {
         const bool slow = random() % 50 == 0;
         return std::normal_distribution<double>(slow ? 4e6 : 3e4, 1e3)(random);
       }},
  };
  std::mt19937_64 random(17);
  for (const Source& source : sources) {
    for (const std::size_t count : {1U, 7U, 1000U, 20'000U}) {
      Histogram times;
      std::vector<std::int64_t> sorted;
      for (std::size_t i = 0; i < count; ++i) {
        sorted.push_back(std::clamp(std::llround(source.draw(random)), 0LL, kLongest + 0LL));
        times.add(sorted.back());
      }
      std::sort(sorted.begin(), sorted.end());
      for (const double percent : {1.0, 10.0, 50.0, 90.0, 99.0, 99.9, 100.0}) {
        const auto rank = std::ceil(percent / 100 * static_cast<double>(count));
        const auto exact = static_cast<double>(sorted[static_cast<std::size_t>(rank) - 1]);
        const auto shown = static_cast<double>(times.look().percentile(percent).count());
        EXPECT_LE(std::abs(shown - exact), std::max(2.0, 0.032 * exact))
            << source.name << " " << count << " p" << percent << ": " << shown << " of " << exact;
      }
    }
  }
}

TEST(Histogram, KeepsTheSharesWhenACountIsFull) {
  HistogramOf<std::uint8_t> times;
  for (int i = 0; i < 3000; ++i) times.add(i % 4 == 0 ? 1'000'000 : 1000);

  const Distribution seen = times.look();

  EXPECT_EQ(seen.count, 3000U);
  EXPECT_EQ(seen.sum, Duration{750'000'000 + 2'250'000});
  ASSERT_EQ(seen.buckets.size(), 2U);
  const double share = static_cast<double>(seen.buckets[1].count) /
                       static_cast<double>(seen.buckets[0].count + seen.buckets[1].count);
  EXPECT_NEAR(share, 0.25, 0.02);
}

TEST(Histogram, CanBeReadWhileItIsWritten) {
  constexpr std::uint64_t kSamples = 200'000;
  Histogram times;
  std::atomic<bool> over{false};
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kSamples; ++i) times.add(static_cast<std::int64_t>(i % 5000));
    over = true;
  });
  std::uint64_t last = 0;
  while (!over) {
    const Distribution seen = times.look();
    EXPECT_GE(seen.count, last);
    EXPECT_LE(seen.percentile(99), Duration{4999});
    last = seen.count;
  }
  writer.join();

  EXPECT_EQ(times.look().count, kSamples);
}

}  // namespace
}  // namespace mauve::rt
