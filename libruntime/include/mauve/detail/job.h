// SPDX-License-Identifier: LGPL-3.0-or-later
/// The job that the calling thread is running: clock reading, lock bound, held resources.
/// For the runtime; components use mauve/job.h.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

class ResourceLock;
class PortBase;
struct LockState;
namespace rt {
class TraceRing;
}

/// One per thread. JobRunner fills it when a job begins; other threads keep the defaults.
struct Job {
  static constexpr std::size_t kMaxHeld = 8;  ///< deepest nesting of resources, checked at connect

  Instant start = 0;       ///< monotonic time read when this job began; 0 outside a job
  Instant release = 0;     ///< logical release of this job, monotonic; 0 outside a job
  Duration step{0};        ///< see time_step(); 0 outside a job
  Duration lock_bound{0};  ///< how long an access may wait for a resource; 0: one second
  bool running = false;    ///< between release and wait: no deployer call, no configure, no cleanup
  /// Every port behaves as if it were not connected: while a core is prepared, and on a thread that
  /// is abandoned because its job did not return.
  std::atomic<bool> no_ports{false};
  [[nodiscard]] bool has_no_ports() const { return no_ports.load(std::memory_order_relaxed); }
  rt::TraceRing* trace = nullptr;  ///< where this thread records its actions; null: nowhere
  /// The waits of this job for resources that others held.
  struct LockWaits {
    std::uint32_t count = 0;
    Duration sum{0};
    Duration longest{0};
  };
  LockWaits lock_waits;
  const PortBase* implausible = nullptr;  ///< the first that was given a value it does not let out
  /// The innermost resource whose service an exception left, since this job entered a resource
  /// last.
  const ResourceLock* threw_in = nullptr;
  /// Locks of resources that this thread holds, innermost last; the guard may look.
  std::atomic<std::size_t> held_count{0};
  std::array<std::atomic<LockState*>, kMaxHeld> held{};
};

namespace detail {

// libmauve is loaded at start: its thread-local storage needs no call and no allocation.
[[gnu::tls_model("initial-exec")]] extern constinit thread_local Job job;
[[nodiscard]] Instant time_outside_jobs();

}  // namespace detail

/// The calling thread's job. [any]
[[nodiscard]] inline Job& this_job() { return detail::job; }

/// Refuses the function `what`, which takes locks, time and memory, when the calling thread runs a
/// job. [any]
[[nodiscard]] Status refuse_in_job(const std::string& at, const char* what);

/// While it lives, ports used by this thread are not connected. [factory]: a core that is being
/// prepared can move nothing.
class NoPorts {
 public:
  NoPorts() : before_(this_job().no_ports.exchange(true)) {}
  ~NoPorts() { this_job().no_ports = before_; }
  NoPorts(const NoPorts&) = delete;
  NoPorts& operator=(const NoPorts&) = delete;

 private:
  bool before_;
};

}  // namespace mauve
