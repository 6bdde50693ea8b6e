// SPDX-License-Identifier: LGPL-3.0-or-later
/// Deadline: ends user code that a thread runs outside of jobs, where no guard looks at it.
#pragma once

#include <ctime>

#include "rt/thread/run_guarded.h"

namespace mauve::rt {

/// While one lives, a body that its thread runs with watched() is ended as by the guard when the
/// time is over, and so is each later one. Code of the system, a sleep for instance, is not
/// interrupted, and nothing is where faults are not handled. Ordinary threads only.
class Deadline {
 public:
  explicit Deadline(Duration most);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  [[nodiscard]] const Watched& watched() const { return watched_; }

 private:
  Watched watched_;
  timer_t timer_{};
  bool armed_ = false;
};

}  // namespace mauve::rt
