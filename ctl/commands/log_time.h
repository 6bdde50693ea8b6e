// SPDX-License-Identifier: LGPL-3.0-or-later
/// Times as people write them.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace mauve::ctl {

/// "10min" before now, "12:30" of the last 24 hours here, or a whole time as it is: for the wire,
/// in UTC. Nothing when it is neither.
[[nodiscard]] std::optional<std::string> since_when(std::string_view text,
                                                    std::chrono::system_clock::time_point now);

}  // namespace mauve::ctl
