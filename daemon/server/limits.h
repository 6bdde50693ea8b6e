// SPDX-License-Identifier: LGPL-3.0-or-later
/// The limits to the load that one client may cause in the daemon.
#pragma once

#include <chrono>
#include <cstddef>

#include "protocol/framing.h"

namespace mauve::server {

/// The defaults are the promise of daemon/protocol/README.md; tests use shorter times.
struct Limits {
  std::size_t line = protocol::kMaxLine;  ///< bytes
  std::size_t clients = 32;
  std::size_t clients_per_uid = 8;
  std::size_t reserved_for_root = 1;  ///< beyond both limits above
  /// Beyond all: clients that may only stop. One that waits for its answer never loses its place.
  std::size_t reserved_for_stop = 96;
  std::size_t stops_per_uid = 32;            ///< of these
  std::size_t in_flight = 8;                 ///< requests of one client; then it is not read
  std::size_t subscriptions = 64;            ///< of one client
  std::size_t unsent_soft = 256 * 1024;      ///< bytes; notifications are dropped from here on
  std::size_t unsent_hard = 1024 * 1024;     ///< bytes; the client is disconnected
  std::chrono::milliseconds stalled{5'000};  ///< over the soft limit and not a byte read
  std::chrono::milliseconds first_byte{5'000};
  std::chrono::milliseconds idle{60'000};  ///< without a subscription and without a request
  std::chrono::milliseconds half_request{10'000};
  double mutations_per_second = 1000;  ///< of one uid; uid 0 is free
};

}  // namespace mauve::server
