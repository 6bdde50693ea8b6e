// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probe: a thread above all others that notes when it was woken late itself. Then the host, or
/// foreign work, held up everything on that CPU, and what was late there is not the components'
/// fault.
#pragma once

#include <atomic>

#include "mauve/result.h"
#include "mauve/trace.h"
#include "rt/thread.h"
#include "rt/trace_ring.h"

namespace mauve::daemon {

class Probe {
 public:
  static constexpr Instant kPeriod = 1'000'000;  ///< costs 0.3 % of a CPU
  static constexpr Instant kLate = 200'000;

  explicit Probe(int cpu) : cpu_(cpu) {}
  ~Probe();
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  /// Refused without the rights for it.
  Status start();
  /// What was noted since the last time. One caller.
  template <typename Visit>
  void drain(Instant t0, Visit&& visit) {
    const auto thread = trace_name_id("[probe]");
    ring_.drain(
        [&](const rt::TraceEntry& entry) {
          visit(TraceRecord{entry.time - t0, entry.kind, thread, 0, entry.value, 0});
        },
        [](std::uint64_t /*lost*/) {});
  }

 private:
  void run();

  const int cpu_;
  rt::TraceRing ring_;
  std::atomic<bool> quit_{false};
  rt::Thread thread_;
};

}  // namespace mauve::daemon
