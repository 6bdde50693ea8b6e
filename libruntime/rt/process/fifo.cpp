// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/fifo.h"

#include <algorithm>

#include "rt/process/process.h"

namespace mauve::rt {
namespace {

Error refused_to_user(const FifoFacts& facts, const std::string& what) {
  if (facts.priority_limit > 0) {
    return refuse({Errc::not_permitted, "realtime_not_permitted"}, "realtime",
                  "no permission for " + what + ": RLIMIT_RTPRIO is " +
                      std::to_string(facts.priority_limit) + ", and CAP_SYS_NICE is missing",
                  "raise the limit: `USER - rtprio 99` in /etc/security/limits.conf, "
                  "LimitRTPRIO=99 in a unit; or lower task.priority; or grant CAP_SYS_NICE");
  }
  if (facts.root) {
    return refuse(
        {Errc::not_permitted, "realtime_not_permitted"}, "realtime",
        "no permission for " + what +
            ": CAP_SYS_NICE is missing, although the user is root, and RLIMIT_RTPRIO is 0",
        "keep CAP_SYS_NICE where it was dropped: CapabilityBoundingSet= in a unit, "
        "--cap-add=SYS_NICE for a container; or set LimitRTPRIO=99");
  }
  return refuse({Errc::not_permitted, "realtime_not_permitted"}, "realtime",
                "no permission for " + what + ": CAP_SYS_NICE is missing, and RLIMIT_RTPRIO is 0",
                "grant CAP_SYS_NICE, or a limit: `USER - rtprio 99` in "
                "/etc/security/limits.conf, LimitRTPRIO=99 in a unit. Where the unit has that "
                "limit, its manager may not raise it (a container): use mauved-capabilities.conf");
}

}  // namespace

FifoFacts fifo_facts(int priority) {
  const ProcessFacts mine = process_facts("/", "thread-self");
  return {priority, mine.nice_capability, mine.root, mine.priority_limit, mine.group_runtime_us};
}

Error fifo_refusal(const FifoFacts& facts) {
  const std::string what = "SCHED_FIFO priority " + std::to_string(facts.priority);
  const bool within_limit = facts.priority_limit >= static_cast<std::uint64_t>(facts.priority);
  if (!facts.nice_capability && !within_limit) return refused_to_user(facts, what);
  if (facts.group_runtime == 0) {
    return refuse({Errc::not_permitted, "realtime_group_without_time"}, "realtime",
                  "the kernel refuses " + what +
                      ": the control group has no real-time run time (cpu.rt_runtime_us is 0)",
                  "give the group a budget (cpu.rt_runtime_us), start in the root group, or boot "
                  "with rt_group_sched=0");
  }
  return refuse({Errc::not_permitted, "realtime_group_without_time"}, "realtime",
                "the kernel refuses " + what + " although " +
                    (facts.nice_capability ? "CAP_SYS_NICE is there" : "RLIMIT_RTPRIO allows it"),
                "look for a control group without real-time run time (start in the root group, or "
                "boot with rt_group_sched=0), a user namespace, or a system call filter");
}

std::optional<std::string> cpu_group(std::string_view cgroups) {
  while (!cgroups.empty()) {
    const std::string_view line = cgroups.substr(0, cgroups.find('\n'));
    cgroups.remove_prefix(std::min(cgroups.size(), line.size() + 1));
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string_view::npos || second == std::string_view::npos) continue;
    // ",cpu,cpuacct,"
    std::string controllers(line.substr(first, second - first));
    controllers.front() = ',';
    controllers += ',';
    if (controllers.find(",cpu,") == std::string::npos) continue;
    const std::string_view path = line.substr(second + 1);
    return path == "/" ? "" : std::string(path);
  }
  return std::nullopt;
}

}  // namespace mauve::rt
