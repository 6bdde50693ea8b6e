// SPDX-License-Identifier: LGPL-3.0-or-later
#include "doctor/checks.h"

namespace mauve::ctl::doctor {
namespace {

constexpr Check kChecks[] = {
    {"mauved", check_daemon},
    {"versions", check_versions},
    {"rtprio of mauved", check_priority_of_daemon},
    {"rtprio of you", check_priority_of_caller},
    {"memlock of mauved", check_locking_of_daemon},
    {"memlock of you", check_locking_of_caller},
    {"control group", check_group},
    {"policy in force", check_policy},
    {"guard", check_guard},
    {"locked memory", check_locked},
    {"guardian", check_guardian},
    {"throttling", check_throttling},
    {"preemption", check_preemption},
    {"foreign threads", check_foreign},
    {"huge pages", check_huge_pages},
    {"swap", check_swap},
    {"clock source", check_clock},
    {"frequency", check_frequency},
    {"isolated CPUs", check_isolation},
    {"sleep states", check_sleep},
    {"virtual machine", check_virtual},
    {"plugin directories", check_plugins},
    {"trusted paths", check_trust},
    {"socket", check_socket},
    {"state directory", check_state},
    {"disk space", check_space},
};

}  // namespace

std::string_view to_string(Grade grade) {
  switch (grade) {
    case Grade::ok:
      return "OK";
    case Grade::warn:
      return "WARN";
    case Grade::fail:
      break;
  }
  return "FAIL";
}

std::span<const Check> checks() { return kChecks; }

}  // namespace mauve::ctl::doctor
