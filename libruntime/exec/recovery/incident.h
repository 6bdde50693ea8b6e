// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the record of a fault, as its task wrote it, to the text that users read.
#pragma once

#include <mauve/host/report.h>

namespace mauve::exec {

struct FaultRecord;
class System;

/// [control]
[[nodiscard]] Incident incident_of(const System& system, const FaultRecord& record);

}  // namespace mauve::exec
