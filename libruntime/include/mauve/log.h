// SPDX-License-Identifier: LGPL-3.0-or-later
/// Log messages from core code: wait-free, formatted later by the [log] thread.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include <mauve/host/version.h>

namespace mauve {

/// Importance of a message. mauved shows those from a level on (`mauvectl log level`).
enum class LogLevel : std::uint8_t { debug, info, warning, error };

/// One argument of a message: an integer or a number.
struct LogArgument {
  bool is_number = false;  ///< `number` is set, else `integer`
  /// @cond the reference cannot link to members of a union without a name
  union {
    std::int64_t integer = 0;
    double number;
  };
  /// @endcond
  LogArgument() = default;  ///< zero
  /// Any integer.
  LogArgument(std::integral auto value) : integer(static_cast<std::int64_t>(value)) {}
  /// Any number.
  LogArgument(std::floating_point auto value)
      : is_number(true), number(static_cast<double>(value)) {}
};

/// `mauve::log(LogLevel::warning, "frame of {} bytes refused, {} so far", size, count);`
/// The text must be a literal: only its address is stored. At most two arguments. Wait-free; when
/// the ring is full the message is counted as lost. Outside a component's thread it does nothing.
void log_event(LogLevel level, const char* literal, LogArgument a, LogArgument b);

/// See log_event(). [rt], wait-free.
/// @snippet api_examples.cpp log
template <std::size_t N>
void log(LogLevel level, const char (&literal)[N], LogArgument a = {}, LogArgument b = {}) {
  log_event(level, literal, a, b);
}

}  // namespace mauve
