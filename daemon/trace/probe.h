// SPDX-License-Identifier: LGPL-3.0-or-later
/// The probe of a trace: notes in the trace when the host, or foreign work, held up everything on
/// its CPU. Components that were late there then are not to blame.
#pragma once

#include "mauve/result.h"
#include "mauve/trace.h"
#include "rt/machine/probe.h"
#include "rt/ring/trace_ring.h"

namespace mauve::daemon {

class Probe {
 public:
  static constexpr Duration kPeriod{1ms};  ///< costs 0.3 % of a CPU
  static constexpr Duration kLate{200us};

  explicit Probe(int cpu)
      : probe_(cpu, kPeriod, [this](Instant due, Instant ran) { note(due, ran); }) {}

  /// Refused without the rights for it.
  Status start() { return probe_.start(); }
  /// Hands the records since the last call to `visit`. Only one thread may call it.
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
  void note(Instant due, Instant ran) {
    if (ran - due > kLate.count()) ring_.push(TraceKind::disturbed, ran, 0, 0, ran - due);
  }

  rt::TraceRing ring_;
  rt::Probe probe_;
};

}  // namespace mauve::daemon
