// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bindings: which service each port of a shell is connected to.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <mauve/time.h>

namespace mauve {

struct Exchange;
class ServiceBase;

/// One connection of one port. Immutable; owns the reader slot and keeps the service's plugin
/// loaded. Made and destroyed off the real-time threads.
class Binding {
 public:
  Binding(ServiceBase& service, std::shared_ptr<void> keep_alive, Duration max_age);
  ~Binding();
  Binding(const Binding&) = delete;
  Binding& operator=(const Binding&) = delete;

  [[nodiscard]] ServiceBase& service() const { return service_; }
  /// Never used twice, so that a port notices that it was connected anew.
  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] unsigned slot() const { return slot_; }
  [[nodiscard]] Duration max_age() const { return max_age_; }

  /// Where the values lie; null: the service computes them.
  [[nodiscard]] const Exchange* exchange() const { return exchange_; }
  /// The same, when the port has a slot of its own there, which a write port tries to claim; else
  /// null. [rt]
  [[nodiscard]] Exchange* is_direct() const;
  /// Writes a value for a write port, on the thread of its component or on the thread that replaced
  /// it: into the exchange, or by a call of the service. False: the value was not delivered. [rt]
  bool write(const void* value) const;
  /// After write_alone(): taps that were attached meanwhile get the value; true. [rt]
  bool notify_taps(const void* value, Instant stamp) const;

 private:
  std::shared_ptr<void> keep_alive_;
  ServiceBase& service_;
  std::uint64_t id_;
  unsigned slot_;
  Duration max_age_;    // zero: no limit
  Exchange* exchange_;  // null: the service computes its values
};

/// The connections of all ports of a shell, by port index; null where not connected. A change
/// makes a new table; the component's own thread exchanges the pointer at a boundary.
using Bindings = std::vector<std::shared_ptr<const Binding>>;

}  // namespace mauve
