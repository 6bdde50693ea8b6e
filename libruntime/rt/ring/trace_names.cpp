// SPDX-License-Identifier: LGPL-3.0-or-later
/// The names in traces: a table that only grows, so that a number stays good after its plugin went.
#include <array>
#include <deque>
#include <map>

#include <mauve/trace.h>

#include "base/mutex.h"

namespace mauve {
namespace {

/// More than any architecture has; a name that is made up anew each time must not fill the memory.
constexpr std::size_t kMostNames = 65'536;

struct Names {
  Mutex mutex;
  std::deque<std::string> by_number MAUVE_GUARDED_BY(mutex){""};  // addresses stay
  std::map<std::string_view, std::uint32_t, std::less<>> numbers MAUVE_GUARDED_BY(mutex){
      {by_number.front(), 0}};
};

/// Never destroyed: abandoned threads outlive everything.
Names& names() {
  static Names* const all = new Names;
  return *all;
}

}  // namespace

std::atomic<TraceMode> detail::trace_mode{TraceMode::jobs};

void set_trace_mode(TraceMode mode) { detail::trace_mode.store(mode, std::memory_order_relaxed); }
TraceMode trace_mode() { return detail::trace_mode.load(std::memory_order_relaxed); }

std::uint32_t trace_name_id(std::string_view name) {
  Names& all = names();
  const MutexLock lock(all.mutex);
  if (const auto known = all.numbers.find(name); known != all.numbers.end()) return known->second;
  if (all.by_number.size() == kMostNames) return 0;
  const auto number = static_cast<std::uint32_t>(all.by_number.size());
  all.numbers.emplace(all.by_number.emplace_back(name), number);
  return number;
}

std::string_view trace_name(std::uint32_t id) {
  Names& all = names();
  const MutexLock lock(all.mutex);
  return id < all.by_number.size() ? std::string_view(all.by_number[id]) : std::string_view{};
}

std::string_view to_string(TraceKind kind) {
  constexpr auto kWords = std::to_array<std::string_view>(
      {"release", "begin",   "end",        "wait",    "lock",   "unlock", "timeout",
       "call",    "user",    "overrun",    "budget",  "missed", "fault",  "started",
       "stopped", "applied", "given_back", "prepare", "commit", "abort",  "rollback",
       "member",  "set",     "disturbed",  "lost"});
  static_assert(kWords.size() == static_cast<std::size_t>(TraceKind::lost) + 1);
  const auto index = static_cast<std::size_t>(kind);
  return index < kWords.size() ? kWords[index] : "unknown";
}

}  // namespace mauve
