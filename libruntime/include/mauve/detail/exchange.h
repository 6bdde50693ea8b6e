// SPDX-License-Identifier: LGPL-3.0-or-later
/// Exchange: the inner part of a SharedData. Runtime only; a port that is connected to one reads
/// and writes here without a call.
#pragma once

#include <cstddef>
#include <cstring>

#include <mauve/detail/data_status.h>
#include <mauve/detail/job.h>
#include <mauve/detail/latest_value.h>
#include <mauve/detail/tap.h>

namespace mauve {

struct Exchange {
  Exchange(std::size_t size, unsigned readers) : latest(size, readers) {}

  /// The size of a value to copy. A small constant size is copied without a call; for a larger one
  /// the C library has code for this CPU.
  template <typename T>
  [[nodiscard]] std::size_t bytes_of() const {
    return sizeof(T) <= 128 ? sizeof(T) : latest.size();
  }
  /// Copies the value at which the cursor stands. [rt], wait-free.
  template <typename T>
  void copy(T& into, const Cursor& cursor) const {
    std::memcpy(static_cast<void*>(&into), cursor.data, bytes_of<T>());
  }
  /// Called by the thread that owns the writer's slot, also when the resource is poisoned. `size`:
  /// of the value. False: nothing is written, call the service. True: notify the taps. [rt],
  /// wait-free.
  bool write_alone(const void* data, std::size_t size, Instant stamp) {
    return latest.write_alone(data, size, stamp, may_write);
  }
  /// The fast path of write_alone(). False: nothing is written, call write_alone().
  [[gnu::always_inline]] bool write_as_expected(const void* data, std::size_t size, Instant stamp) {
    return latest.write_as_expected(data, size, stamp, may_write);
  }
  static constexpr auto may_write = [] { return !this_job().has_no_ports(); };
  LatestValue latest;
  TapList taps;
};

}  // namespace mauve
