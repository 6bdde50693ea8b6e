// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the record of a fault, as its task wrote it, to the text that users read.
#pragma once

#include <cstdint>
#include <string>

#include <mauve/host/report.h>

namespace mauve::exec {

struct FaultRecord;
class System;

/// [control]
[[nodiscard]] Incident incident_of(const System& system, const FaultRecord& record);
/// "; 402 jobs of control used more processor time than its budget"; empty: none did. [any]
[[nodiscard]] std::string over_budget_in_words(std::uint64_t jobs, const std::string& component);

}  // namespace mauve::exec
