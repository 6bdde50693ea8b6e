// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/preemption.h"

#include <sys/rseq.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ctime>

namespace mauve::rt {
namespace {

/// The beginning and the end of a sequence; never executed.
constexpr std::array<std::uint32_t, 3> kNoCode{RSEQ_SIG, RSEQ_SIG, RSEQ_SIG};

/// A sequence of one byte that no thread is ever in; the kernel wants the signature before the
/// place it would jump to.
rseq_cs make_nowhere() {
  rseq_cs sequence{};
  sequence.start_ip = reinterpret_cast<std::uintptr_t>(&kNoCode[0]);
  sequence.post_commit_offset = 1;
  sequence.abort_ip = reinterpret_cast<std::uintptr_t>(&kNoCode[2]);
  return sequence;
}
const rseq_cs kNowhere = make_nowhere();

std::uint64_t nowhere() { return reinterpret_cast<std::uintptr_t>(&kNowhere); }

/// Of the calling thread, as libc has registered it with the kernel.
auto current_sequence() {
  auto* thread = static_cast<std::byte*>(__builtin_thread_pointer());
  return std::atomic_ref(reinterpret_cast<struct rseq*>(thread + __rseq_offset)->rseq_cs);
}

void set(std::uint64_t sequence) {
  current_sequence().store(sequence, std::memory_order_relaxed);
  std::atomic_signal_fence(std::memory_order_seq_cst);
}

/// A thread that sleeps is preempted, and must find that out.
bool finds_out() {
  if (__rseq_size == 0) return false;
  set(nowhere());
  const timespec moment{0, 1000};
  nanosleep(&moment, nullptr);
  const bool found = current_sequence().load(std::memory_order_relaxed) == 0;
  set(0);
  return found;
}

}  // namespace

bool preemption_is_reported() {
  static const bool reported = finds_out();
  return reported;
}

void watch_for_preemption() {
  if (preemption_is_reported()) set(nowhere());
}

bool preempted() {
  if (!preemption_is_reported()) return true;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  return current_sequence().load(std::memory_order_relaxed) != nowhere();
}

void end_preemption_watch() {
  if (preemption_is_reported()) set(0);
}

}  // namespace mauve::rt
