// SPDX-License-Identifier: LGPL-3.0-or-later
/// The page of this process that its guardian sees (guardian_wire.h), and the beats in it.
#pragma once

#include <string>
#include <string_view>

#include <mauve/result.h>
#include <mauve/time.h>

#include "rt/guardian/guardian_wire.h"
#include "rt/process/descriptor.h"

namespace mauve::rt {

/// From one beat to the next.
inline constexpr Duration kBeatPeriod{10'000'000};

/// Whether a guardian may listen. [any]
[[nodiscard]] bool beats_are_heard();
/// Adds one beat. Call it only while all components are served, on a thread that no load of the
/// machine can hold up. The guardian takes 60 ms without a beat for an end. [rt]
void beat();
/// So long this component with a guarded output is kept from the processor, upon which the guardian
/// acts at once. 0: none is. On the same thread. [rt]
void say_starved(Duration time, std::string_view component);
/// The component that say_starved() named within the last second; empty: none. [any but rt]
[[nodiscard]] std::string starved_component();

namespace guardian {

/// Made by one thread, which lives as long as the page matters. Its memory is never given back,
/// because beats may come at any time.
class OwnPage {
 public:
  /// The calling thread becomes the owner: when it ends in any way, the kernel marks the page
  /// before any other part of the process is removed (robust futexes, set_robust_list(2)).
  Status open();
  /// The last step of that thread: its end is no alarm any more.
  void let_go();
  [[nodiscard]] int file() const { return file_.get(); }
  [[nodiscard]] pid_t owner() const { return owner_; }

 private:
  Descriptor file_;
  pid_t owner_ = 0;
};

}  // namespace guardian
}  // namespace mauve::rt
