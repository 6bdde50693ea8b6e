// SPDX-License-Identifier: LGPL-3.0-or-later
/// OrderSending: a safe order on its way to a device whose component stopped.
#pragma once

#include <chrono>
#include <cstdint>

#include <mauve/time.h>

#include "rt/guardian/guardian_wire.h"

namespace mauve::rt {

/// Sends an order as often and as far apart as it says, and then once more: a thread of the driver
/// may have written bytes of its last job. Never waits for the device. One that takes no bytes goes
/// on with the last command it was given, so it is tried as long as the output is held. One thread
/// at a time.
class OrderSending {
 public:
  /// A device that took no bytes for so long is late, and no thread waits for it any more.
  static constexpr Duration kPatience{std::chrono::milliseconds(guardian::kMostTimeMs)};
  /// From the first time to the second.
  static constexpr Duration kOnceMore{50ms};

  void begin(const guardian::Order& order, Instant now);
  void cancel() { rounds_ = 0; }
  [[nodiscard]] bool under_way() const { return rounds_ > 0; }
  [[nodiscard]] bool late() const { return late_; }
  /// All that is due. Returns when to call it again; kForever: it is over.
  Instant advance(const guardian::Order& order, int descriptor, Instant now);

 private:
  [[nodiscard]] bool write_one(const guardian::Order& order, int descriptor);
  void begin_round(const guardian::Order& order, Instant due);

  int rounds_ = 0;  // left, with the present one
  bool late_ = false;
  bool begun_ = false;       // this round
  std::uint32_t times_ = 0;  // left in this round
  std::uint32_t bytes_ = 0;  // of the next time, gone
  Instant due_ = 0;
  Instant until_ = 0;
};

}  // namespace mauve::rt
