// SPDX-License-Identifier: LGPL-3.0-or-later
/// Parts of the benchmark `robot`: what the algorithms of the paper's robot reach, each in a table
/// of its own.
#pragma once

#include "bench/support/report.h"

namespace bench {

/// The localization on the recording of Victoria Park, and what its services cost. Draws
/// build/bench/victoria_park.svg.
void report_localization(const Options& options);

/// The planner on a million cells, and on them the length of its ways.
void report_navigation(const Options& options);

/// The guidance in random worlds, through swaps, and in the building. Draws
/// build/bench/control.svg.
void report_control(const Options& options);

}  // namespace bench
