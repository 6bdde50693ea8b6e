// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bytes to lines to JSON: the strict part of the wire. No state is shared, any thread.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "mauve/result.h"

namespace mauve::protocol {

using Json = nlohmann::json;

/// Longest request, in bytes without the end of line.
inline constexpr std::size_t kMaxLine = 1024 * 1024;
/// Objects and arrays that may be open at once, the outermost counted.
inline constexpr std::size_t kMaxDepth = 32;
/// Values in one request: reading half a million of them takes 40 ms, in which no client is served.
inline constexpr std::size_t kMaxValues = 20'000;

/// Cuts a stream of bytes into lines. Feed the bytes that arrived, then take lines until there is
/// none.
class LineFramer {
 public:
  explicit LineFramer(std::size_t limit = kMaxLine) : limit_(limit) {}

  /// Takes any number of bytes. Refuses (Errc::limit) a line longer than the limit; lines complete
  /// before it can still be read, everything after it is ignored: the stream has no meaning any
  /// more.
  Status feed(std::string_view bytes);

  /// The next complete line without its end ("\n" or "\r\n"). Empty lines are left out.
  [[nodiscard]] std::optional<std::string> next();

  /// True while the beginning of a line waits for its end.
  [[nodiscard]] bool partial() const { return !partial_.empty(); }

 private:
  void finish_line();

  std::size_t limit_;
  std::deque<std::string> lines_;
  std::string partial_;
  bool overflown_ = false;
};

/// Strict JSON: refuses text that RFC 8259 refuses, and nesting beyond kMaxDepth, duplicate keys,
/// NaN, invalid UTF-8, anything behind the value, and more values than `most_values`. Error.at is
/// "byte N", counted from 1.
[[nodiscard]] Result<Json> parse_json(std::string_view text,
                                      std::size_t most_values = std::string_view::npos);

/// One line of JSON without its end; invalid UTF-8 becomes U+FFFD. Never throws for that reason.
[[nodiscard]] std::string to_line(const Json& value);

}  // namespace mauve::protocol
