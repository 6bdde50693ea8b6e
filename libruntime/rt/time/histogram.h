// SPDX-License-Identifier: LGPL-3.0-or-later
/// Histogram of times in constant memory, written by one thread, read by any thread meanwhile.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <mauve/host/statistics.h>

namespace mauve::rt {

/// Each octave has 16 buckets of equal width, from 64 ns to 17 s; below there are 16 of 4 ns. One
/// writer, so loads and stores are enough.
template <typename Count>
class HistogramOf {
 public:
  static constexpr std::size_t kParts = 16;
  static constexpr unsigned kFirstOctave = 6;
  static constexpr unsigned kEnd = 34;  ///< longer times are in the last bucket
  static constexpr std::size_t kBuckets = kParts * (kEnd - kFirstOctave + 1);

  /// Nanoseconds; less than zero counts as zero. [rt]
  void add(std::int64_t value) {
    const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(value, 0));
    count_up(buckets_[index_of(time)]);
    store(count_, load(count_) + 1);
    store(sum_, load(sum_) + time);
    if (time < load(min_)) store(min_, time);
    if (time > load(max_)) store(max_, time);
  }
  /// While no thread writes.
  void clear() {
    for (auto& bucket : buckets_) store(bucket, Count{0});
    store(count_, std::uint64_t{0});
    store(sum_, std::uint64_t{0});
    store(min_, kNone);
    store(max_, std::uint64_t{0});
  }
  /// Numbers may be some samples apart while the thread writes. [any]
  [[nodiscard]] Distribution look() const {
    Distribution seen;
    seen.count = load(count_);
    if (seen.count == 0) return seen;
    seen.sum = duration(load(sum_));
    seen.min = duration(load(min_));
    seen.max = duration(load(max_));
    const std::size_t last = index_of(load(max_));
    for (std::size_t i = index_of(load(min_)); i <= last; ++i) {
      if (const Count count = load(buckets_[i]); count != 0) {
        seen.buckets.push_back({duration(lower(i)), duration(lower(i + 1)), count});
      }
    }
    return seen;
  }

  static constexpr std::size_t index_of(std::uint64_t time) {
    if (time < (1ULL << kFirstOctave)) return time / 4;
    if (time >= (1ULL << kEnd)) return kBuckets - 1;
    const auto octave = static_cast<unsigned>(std::bit_width(time)) - 1;
    return kParts * (octave - kFirstOctave + 1) + ((time >> (octave - 4)) & (kParts - 1));
  }
  /// Where a bucket begins, and the one before it ends.
  static constexpr std::uint64_t lower(std::size_t index) {
    if (index < kParts) return 4 * index;
    return (kParts + index % kParts) << (index / kParts + kFirstOctave - 5);
  }

 private:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  template <typename T>
  static T load(const std::atomic<T>& word) {
    return word.load(std::memory_order_relaxed);
  }
  template <typename T>
  static void store(std::atomic<T>& word, T value) {
    word.store(value, std::memory_order_relaxed);
  }
  static Duration duration(std::uint64_t time) { return Duration{static_cast<std::int64_t>(time)}; }

  void count_up(std::atomic<Count>& bucket) {
    if (load(bucket) == std::numeric_limits<Count>::max()) halve();
    store(bucket, static_cast<Count>(load(bucket) + 1));
  }
  /// Once in seven weeks at 1 kHz: the shares stay as they are, and newer samples weigh more.
  void halve() {
    for (auto& bucket : buckets_) store(bucket, static_cast<Count>(load(bucket) / 2));
  }

  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> sum_{0};
  std::atomic<std::uint64_t> min_{kNone};
  std::atomic<std::uint64_t> max_{0};
  std::array<std::atomic<Count>, kBuckets> buckets_{};
};

using Histogram = HistogramOf<std::uint32_t>;

}  // namespace mauve::rt
