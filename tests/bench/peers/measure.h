// SPDX-License-Identifier: LGPL-3.0-or-later
/// One round of one peer: a writer and a reader of 1 kHz, SCHED_FIFO 50, on one CPU; the reader's
/// releases lie half a period behind those of the writer.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"

namespace bench::peers {

inline constexpr Duration kPeriod{1'000'000};
inline constexpr int kPriority = 50;
inline constexpr std::array<std::size_t, 4> kSizes{100, 1000, 10'000, 100'000};

/// The calls of one thread, noted by that thread.
struct Calls {
  Instants begins{1 << 12};
  Instants ends{1 << 12};

  template <typename Call>
  void time(const Call& call) {
    const Instant begin = now();
    call();
    ends.add(now());
    begins.add(begin);
  }
};

/// The job of the writer and the job of the reader, alike for every peer. The value begins with its
/// number.
class Exchange {
 public:
  explicit Exchange(std::size_t size) : from_(size), into_(size) {}

  template <typename Write>
  void write(const Write& call) {
    ++number_;
    std::memcpy(from_.data(), &number_, sizeof number_);
    writes_.time([&] { call(from_.data()); });
  }
  template <typename Read>
  void read(const Read& call) {
    reads_.time([&] { call(into_.data()); });
    std::uint64_t number = 0;
    std::memcpy(&number, into_.data(), sizeof number);
    arrived_ += number != newest_ ? 1 : 0;
    newest_ = number;
  }
  [[nodiscard]] const Calls& writes() const { return writes_; }
  [[nodiscard]] const Calls& reads() const { return reads_; }
  [[nodiscard]] std::size_t arrived() const { return arrived_; }

 private:
  std::vector<std::byte> from_;
  std::vector<std::byte> into_;
  std::uint64_t number_ = 0;
  std::uint64_t newest_ = 0;
  std::size_t arrived_ = 0;
  Calls writes_;
  Calls reads_;
};

struct Round {
  std::vector<double> writes;  ///< ns of each call
  std::vector<double> reads;   ///< the same
  std::vector<double> steps;   ///< us from the release of the writer until its call has returned
  std::size_t read_jobs = 0;
  std::size_t arrived = 0;  ///< reads that found another value than the read before
};

/// The jobs after the first twenty; `first` is the first release of the writer.
[[nodiscard]] Round result_of(const Exchange& exchange, Instant first);

[[nodiscard]] Round measure_peer(Peer& peer, std::size_t size, int cpu, Duration time);
/// Two components and a SharedData between them.
[[nodiscard]] Round measure_mauve(std::size_t size, int cpu, Duration time);

}  // namespace bench::peers
