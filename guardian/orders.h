// SPDX-License-Identifier: LGPL-3.0-or-later
/// The orders that a guardian holds, and how they go out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "rt/guardian/guardian_wire.h"

namespace mauve::guardian {

namespace wire = rt::guardian;

/// Of sending all orders.
struct Sent {
  std::uint32_t whole = 0;  ///< orders that went out as often as they shall
  std::uint32_t total = 0;
};

/// Descriptors and bytes; no memory is allocated after the start. One thread.
class Orders {
 public:
  Orders() = default;
  ~Orders() { drop_all(); }
  Orders(const Orders&) = delete;
  Orders& operator=(const Orders&) = delete;

  /// Takes the descriptor in any case. Why it does not hold the order; nullptr: it does.
  [[nodiscard]] const char* hold(std::uint32_t slot, const wire::Order& order, int descriptor);
  /// Closes its descriptor. A slot without an order stays as it is.
  void drop(std::uint32_t slot);
  void drop_all();
  [[nodiscard]] std::uint32_t count() const;
  /// Sends each order as often and as far apart as it requires, without waiting for any device. An
  /// order that has not gone out after kMostTimeMs is dropped, and named on standard error. Calls
  /// `meanwhile` while it waits for the time of an order.
  Sent send(const std::function<void()>& meanwhile);

 private:
  struct Held {
    wire::Order order;
    int descriptor = -1;
    std::uint32_t times = 0;  // it went out so often
    std::uint32_t bytes = 0;  // of the next time
    std::int64_t due = 0;     // when it goes out next, nanoseconds
    int error = 0;            // of the last attempt
  };
  static void begin(Held& held, std::int64_t now);
  [[nodiscard]] static bool advance(Held& held, std::int64_t now);
  static void report_failure(const Held& held);

  std::array<Held, wire::kMostOutputs> held_;
};

}  // namespace mauve::guardian
