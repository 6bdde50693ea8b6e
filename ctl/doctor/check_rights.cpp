// SPDX-License-Identifier: LGPL-3.0-or-later
/// Checks of the rights of mauved and the caller: priorities, locked memory, run time of the
/// control group.
#include <algorithm>

#include "doctor/checks.h"
#include "render/words.h"
#include "rt/process/process.h"

namespace mauve::ctl::doctor {
namespace {

constexpr std::uint64_t kGuard = 95;  // the highest priority that mauved uses

/// Whose rights they are, and how more are granted there.
struct Holder {
  bool service = false;  ///< of a service manager: a unit grants, else a login
  bool wanted = true;    ///< false: it does without by choice
  std::string group;     ///< whose logins get a limit
};

rt::ProcessFacts facts_of(const Json& daemon) {
  rt::ProcessFacts facts;
  facts.root = word(daemon, "uid") == "0";
  facts.nice_capability = word(daemon, "sys_nice") == "true";
  facts.lock_capability = word(daemon, "ipc_lock") == "true";
  facts.priority_limit = whole_number(daemon, "rtprio");
  facts.lock_limit = std::nullopt;
  if (word(daemon, "memlock") != "-") facts.lock_limit = whole_number(daemon, "memlock");
  facts.cpu_group = word(daemon, "cpu_group");
  if (const std::string budget = word(daemon, "rt_runtime_us"); budget != "-" && !budget.empty()) {
    facts.group_runtime_us = static_cast<std::int64_t>(number(daemon, "rt_runtime_us"));
  }
  return facts;
}

Holder holder_of(const Facts& facts) {
  return {word(facts.daemon, "service") == "true", facts.asked_realtime() != "off", facts.group};
}

rt::ProcessFacts caller(const Facts& facts) { return rt::process_facts(facts.root, "self"); }

std::string unit(const std::string& line) {
  return "systemctl edit mauved, below [Service]: " + line + "; then systemctl restart mauved";
}

std::string login(const Holder& holder, const std::string& line) {
  return "in /etc/security/limits.conf: @" + holder.group + " - " + line + "; then log in again";
}

Finding judged(const Holder& holder, bool needed, const std::string& found,
               const std::string& remedy) {
  return holder.wanted && needed ? bad(found, remedy) : doubt(found, remedy);
}

Finding priority(const rt::ProcessFacts& facts, const Holder& holder, bool needed) {
  if (facts.nice_capability) return good("CAP_SYS_NICE: any priority");
  const std::string limit = "RLIMIT_RTPRIO is " + std::to_string(facts.priority_limit);
  if (facts.priority_limit >= kGuard) return good(limit);
  const std::string remedy = holder.service ? unit("LimitRTPRIO=99") : login(holder, "rtprio 99");
  const std::string without = ", without CAP_SYS_NICE";
  if (facts.priority_limit > 0) {
    return doubt(limit + without + "; the guard needs " + std::to_string(kGuard), remedy);
  }
  const std::string root = facts.root ? ", although the user is root" : "";
  return judged(holder, needed, limit + without + root + ": no SCHED_FIFO thread", remedy);
}

Finding locking(const rt::ProcessFacts& facts, const Holder& holder, bool needed) {
  if (facts.lock_capability) return good("CAP_IPC_LOCK: any amount");
  if (!facts.lock_limit) return good("RLIMIT_MEMLOCK is unlimited");
  const std::string remedy =
      holder.service ? unit("LimitMEMLOCK=infinity") : login(holder, "memlock unlimited");
  return judged(holder, needed,
                "RLIMIT_MEMLOCK is " + std::to_string(*facts.lock_limit / 1024) +
                    " KiB, without CAP_IPC_LOCK: memory is not locked",
                remedy);
}

Finding group_version_1(const rt::ProcessFacts& facts, const Holder& holder) {
  const std::string file = "/sys/fs/cgroup/cpu" + facts.cpu_group + "/cpu.rt_runtime_us";
  const std::string has = file + " is " + std::to_string(*facts.group_runtime_us);
  if (*facts.group_runtime_us != 0) return good(has);
  return judged(holder, true, has + ": the kernel refuses every SCHED_FIFO thread there",
                "echo 950000 > " + file);
}

}  // namespace

Finding check_priority_of_daemon(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  return priority(facts_of(facts.daemon), holder_of(facts), true);
}

Finding check_priority_of_caller(const Facts& facts) {
  return priority(caller(facts), {.group = facts.group}, false);
}

Finding check_locking_of_daemon(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  return locking(facts_of(facts.daemon), holder_of(facts), true);
}

Finding check_locking_of_caller(const Facts& facts) {
  return locking(caller(facts), {.group = facts.group}, false);
}

Finding check_group(const Facts& facts) {
  const bool of_caller = facts.daemon.is_null();
  const auto its = of_caller ? caller(facts) : facts_of(facts.daemon);
  if (its.group_runtime_us) return group_version_1(its, holder_of(facts));
  if (facts.kernel_option("CONFIG_RT_GROUP_SCHED").value_or("") != "y") {
    return good("the kernel does not divide real-time run time among control groups");
  }
  if (facts.boot_option("rt_group_sched") == "0") return good("rt_group_sched=0");
  return doubt(
      "CONFIG_RT_GROUP_SCHED=y: with control groups of version 2 SCHED_FIFO works in the root "
      "group "
      "only",
      "on the kernel's command line: rt_group_sched=0");
}

}  // namespace mauve::ctl::doctor
