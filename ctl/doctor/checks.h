// SPDX-License-Identifier: LGPL-3.0-or-later
/// The checks of `mauvectl doctor`: each a function from facts to a finding, in the order of the
/// table.
#pragma once

#include <span>

#include "doctor/facts.h"
#include "doctor/finding.h"

namespace mauve::ctl::doctor {

struct Check {
  std::string_view name;
  Finding (*look)(const Facts&);
};

[[nodiscard]] std::span<const Check> checks();

// The rights of mauved and the caller.
Finding check_daemon(const Facts& facts);
Finding check_versions(const Facts& facts);
Finding check_priority_of_daemon(const Facts& facts);
Finding check_priority_of_caller(const Facts& facts);
Finding check_locking_of_daemon(const Facts& facts);
Finding check_locking_of_caller(const Facts& facts);
Finding check_group(const Facts& facts);
// The settings in force in mauved.
Finding check_policy(const Facts& facts);
Finding check_guard(const Facts& facts);
Finding check_locked(const Facts& facts);
Finding check_guardian(const Facts& facts);
// The kernel, and the other programs on it.
Finding check_throttling(const Facts& facts);
Finding check_preemption(const Facts& facts);
Finding check_foreign(const Facts& facts);
Finding check_huge_pages(const Facts& facts);
Finding check_swap(const Facts& facts);
// The machine.
Finding check_clock(const Facts& facts);
Finding check_frequency(const Facts& facts);
Finding check_isolation(const Facts& facts);
Finding check_sleep(const Facts& facts);
Finding check_virtual(const Facts& facts);
// Directories.
Finding check_plugins(const Facts& facts);
Finding check_trust(const Facts& facts);
Finding check_socket(const Facts& facts);
Finding check_state(const Facts& facts);
Finding check_space(const Facts& facts);

}  // namespace mauve::ctl::doctor
