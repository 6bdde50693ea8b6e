// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/trace.h>

#include <bit>

#include "model/job/traced.h"

namespace mauve {

void detail::trace_user(std::uint32_t name, double value) {
  rt::TraceRing* const ring = ring_of(this_job(), TraceMode::jobs);
  if (ring == nullptr) return;
  ring->push(TraceKind::user, ring->now(), name, 0, std::bit_cast<std::int64_t>(value));
}

/// 0: this call is not traced.
Instant detail::trace_time() {
  const rt::TraceRing* const ring = ring_of(this_job(), TraceMode::detail);
  return ring == nullptr ? 0 : ring->now();
}

void detail::trace_call(std::uint32_t port, Instant began, DataStatus status) {
  rt::TraceRing* const ring = ring_of(this_job(), TraceMode::detail);
  if (ring == nullptr) return;
  const Instant now = ring->now();
  ring->push(TraceKind::call, now, port, static_cast<std::uint64_t>(status), now - began);
}

}  // namespace mauve
