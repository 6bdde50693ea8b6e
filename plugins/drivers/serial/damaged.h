// SPDX-License-Identifier: LGPL-3.0-or-later
/// Counts and reports damaged frames.
#pragma once

#include <cstdint>

#include <mauve/observable.h>

#include "../../types/reporting.h"

namespace drivers {

/// One more; the 1st, 10th, 100th, ... is reported. [rt]
inline void count_damaged(mauve::Observable<std::uint64_t>& bad_frames) {
  if (rover::worth_reporting(++bad_frames)) {
    mauve::log(mauve::LogLevel::warning, "damaged frames: {} so far", bad_frames.get());
  }
}

}  // namespace drivers
