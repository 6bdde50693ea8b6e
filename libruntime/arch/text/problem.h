// SPDX-License-Identifier: LGPL-3.0-or-later
/// The errors of a file: every one has a place, and a file has as many as it needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/result.h"

namespace mauve::arch {

/// A place in a text. Both count from 1; columns count characters, not bytes. 0 means unknown.
struct Position {
  std::uint32_t line = 0;
  std::uint32_t column = 0;

  friend bool operator==(Position, Position) = default;
  friend auto operator<=>(Position, Position) = default;
};

/// One refusal with its place. `error.at` is the dotted address, empty for a syntax error.
struct Problem {
  Position where;
  Error error;
};

/// "rover.json:12:5: control.task.priority: must be from 1 to 98 (hint)".
[[nodiscard]] std::string to_string(const Problem& problem, std::string_view file);

/// Collects the problems that several passes find. [any], one thread at a time.
class Problems {
 public:
  void add(Position where, Error error);
  void add(Position where, Reason reason, std::string at, std::string message,
           std::string hint = {});

  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  /// In the order of the file; a problem without a place comes last.
  [[nodiscard]] std::vector<Problem> sorted() const;

 private:
  std::vector<Problem> found_;
};

/// "has 2 errors, the first in line 7: control.task.priority: must be from 1 to 98". There is at
/// least one.
[[nodiscard]] std::string summary(const std::vector<Problem>& problems);

}  // namespace mauve::arch
