// SPDX-License-Identifier: LGPL-3.0-or-later
/// The choice of the source that drives: the most urgent one that still speaks.
#pragma once

#include <cstdint>
#include <optional>
#include <tuple>

#include <mauve/property.h>
#include <mauve/time.h>

#include "../types/velocity.h"

namespace teleop {

/// The more urgent, the greater.
enum class Source : std::uint8_t { none, command, teleop };

/// The last command of one source.
struct Said {
  rover::Velocity velocity;
  mauve::Instant at = 0;
  bool ever = false;
};

/// After this long without a word a source counts as silent.
struct Timeouts {
  mauve::Duration teleop{200'000'000};
  mauve::Duration command{200'000'000};

  static auto parameters() {
    using mauve::parameter;
    const mauve::Limits<mauve::Duration> limits{.min = std::chrono::milliseconds(1),
                                                .max = std::chrono::seconds(10)};
    return std::tuple{parameter(/*of teleop*/ "teleop_timeout", &Timeouts::teleop,
                                "then `teleop` counts as silent", limits),
                      parameter(/*of command*/ "command_timeout", &Timeouts::command,
                                "then `command` counts as silent", limits)};
  }
};

/// All sources; the priority resource hands them over in a change.
struct Sources {
  Said teleop;
  Said command;
};

/// False, and nothing happens: it is not a number. [rt]
bool hear(Said& source, const rover::Velocity& velocity, mauve::Instant now);

/// The source that drives now. [rt]
[[nodiscard]] Source choose(const Sources& sources, const Timeouts& timeouts, mauve::Instant now);

/// The last command of that source; empty for none. [rt]
[[nodiscard]] std::optional<rover::Velocity> said_by(Source source, const Sources& sources);

}  // namespace teleop
