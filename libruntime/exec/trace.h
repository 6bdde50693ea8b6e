// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a deployment tells in a trace: the rings of its tasks, and what [control] does.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/trace.h>

namespace mauve {

struct Change;

namespace exec {

class System;
struct Deployed;

/// The records of [control] and [factory]: behind a lock that no real-time thread takes.
class ControlTrace {
 public:
  static constexpr std::size_t kCapacity = 4096;

  void add(const TraceRecord& record);
  /// In order; what was dropped since the last time comes first, as `lost`.
  [[nodiscard]] std::vector<TraceRecord> take();

 private:
  std::mutex mutex_;
  std::deque<TraceRecord> records_;
  std::int64_t lost_ = 0;
};

/// One record of [control]. `instant` on the clock, 0: none. [any but rt]
void tell_control(System& system, TraceKind kind, std::string_view name, Instant instant,
                  std::uint64_t number);

/// A change in the words of the wire: "core.swap control", "component.stop a, b".
[[nodiscard]] std::string what_of(const Change& change);
[[nodiscard]] std::string what_of(std::string_view verb, const std::vector<std::string>& names);
/// The properties it sets: "control.core.gain".
[[nodiscard]] std::vector<std::string> set_by(const Change& change);

/// Deployer::drain_trace(). [trace]
std::size_t drain_trace(System& system, const std::function<void(const TraceRecord&)>& visit);
/// What a component that leaves has told is collected before its task goes. [control]
void keep_last_trace(System& system, Deployed& deployed);
/// Deployer::traced(). [control]
[[nodiscard]] TracedSystem traced(System& system);

}  // namespace exec
}  // namespace mauve
