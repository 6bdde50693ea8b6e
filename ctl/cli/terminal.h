// SPDX-License-Identifier: LGPL-3.0-or-later
/// The terminal as a screen of its own: keys at once, without echo. One at a time.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "top/top.h"

namespace mauve::ctl {

/// While this object lives, the terminal shows another screen. The screen from before comes back at
/// the end, also when a signal ends the process.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Are standard input and output one?
  [[nodiscard]] static bool is_there();

  [[nodiscard]] Extent extent() const;
  void draw(const std::vector<std::string>& lines);

  using Deadline = std::chrono::steady_clock::time_point;
  /// The keys that the user typed; empty at the deadline and when the size changed. Nothing when
  /// the terminal is gone.
  [[nodiscard]] std::optional<std::string> wait(Deadline deadline);

 private:
  bool gone_ = false;
};

}  // namespace mauve::ctl
