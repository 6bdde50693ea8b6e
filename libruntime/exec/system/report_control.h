// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes in a trace, by the names that the wire has for them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/host/prepared_change.h>
#include <mauve/time.h>
#include <mauve/trace.h>

namespace mauve {
struct Change;
}  // namespace mauve

namespace mauve::exec {

class System;

/// One record of [control]. `instant` on the clock, 0: none. [any but rt]
void report_control(System& system, TraceKind kind, std::string_view name, Instant instant,
                    std::uint64_t number);

/// A change in the words of the wire: "core.swap control", "component.stop a, b".
[[nodiscard]] std::string what_of(const Change& change);
[[nodiscard]] std::string what_of(std::string_view verb, const std::vector<std::string>& names);
/// The properties it sets: "control.core.gain".
[[nodiscard]] std::vector<std::string> set_by(const Change& change);

/// The components that take part, in a trace.
void report_members(System& system, const PreparedChange::Content& content, std::uint64_t number);

}  // namespace mauve::exec
