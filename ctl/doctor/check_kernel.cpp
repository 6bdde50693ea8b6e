// SPDX-License-Identifier: LGPL-3.0-or-later
/// The kernel: throttling, preemption, memory; and the other urgent threads on it.
#include <unistd.h>

#include <algorithm>
#include <set>
#include <utility>

#include "doctor/checks.h"
#include "render/table.h"
#include "render/words.h"
#include "rt/process/process.h"

namespace mauve::ctl::doctor {
namespace {

/// Debian's kernel with PREEMPT_RT for this machine.
#if defined(__aarch64__)
constexpr const char* kGetRealTime = "apt install linux-image-rt-arm64";
#else
constexpr const char* kGetRealTime = "apt install linux-image-rt-amd64";
#endif
constexpr std::size_t kNamed = 5;  // foreign threads, the others are counted

/// The word in brackets of "always [madvise] never"; of preemption they are round.
std::string chosen(const std::string& words, char open, char close) {
  const auto begin = words.find(open);
  const auto end = words.find(close, begin);
  if (begin == std::string::npos || end == std::string::npos) return {};
  return words.substr(begin + 1, end - begin - 1);
}

/// The model of a kernel without PREEMPT_RT: "none", "voluntary", "lazy", "full" or "".
std::string preemption_of(const Facts& facts, bool dynamic) {
  if (const auto now = facts.text("sys/kernel/debug/sched/preempt")) {
    if (const auto model = chosen(*now, '(', ')'); !model.empty()) return model;
  }
  if (const auto asked = facts.boot_option("preempt"); asked && dynamic) return *asked;
  if (facts.kernel_option("CONFIG_PREEMPT") == "y") return "full";
  if (facts.kernel_option("CONFIG_PREEMPT_LAZY") == "y") return "lazy";
  if (facts.kernel_option("CONFIG_PREEMPT_VOLUNTARY") == "y") return "voluntary";
  if (facts.kernel_option("CONFIG_PREEMPT_NONE") == "y") return "none";
  return dynamic ? "" : "none or voluntary";
}

/// "pipewire 812", or "process 812" when that has ended meanwhile.
std::string owner_of(const Facts& facts, const rt::ThreadFacts& thread) {
  const std::string process = std::to_string(thread.process);
  return harmless(facts.text("proc/" + process + "/comm").value_or("process")) + " " + process;
}

std::string described(const Facts& facts, const rt::ThreadFacts& thread) {
  return harmless(thread.name) + " (" + owner_of(facts, thread) + ", " + thread.policy + " " +
         std::to_string(thread.priority) + ", CPU " + std::to_string(thread.cpu) + ", used " +
         seconds_in_words(static_cast<double>(thread.ticks) /
                          static_cast<double>(sysconf(_SC_CLK_TCK))) +
         ")";
}

/// The remedy against an urgent thread; one of another mauved needs its priority.
std::string remedy_for(const Facts& facts, const rt::ThreadFacts& thread) {
  const std::string owner = owner_of(facts, thread);
  if (!owner.starts_with("mauved ")) {
    return "chrt --other --pid 0 " + std::to_string(thread.id);
  }
  return "end " + owner + ", or give it other CPUs (\"task\": {\"cpus\": [...]} in its file)";
}

/// It acts when mauved does not, so it is to come before the components.
bool is_guardian(const Facts& facts, const std::string& process) {
  return facts.text("proc/" + process + "/comm") == "mauve-guardian";
}

struct Urgent {
  std::vector<rt::ThreadFacts> foreign;  ///< those that used the processor most come first
  std::size_t kernel = 0;
};

Urgent urgent_threads(const Facts& facts) {
  Urgent urgent;
  const std::string ours = word(facts.daemon, "pid");
  for (const std::string& process : facts.names("proc")) {
    if (process.find_first_not_of("0123456789") != std::string::npos || process == ours ||
        is_guardian(facts, process))
      continue;
    for (const auto& thread : rt::threads_of(facts.root, process)) {
      if (!thread.urgent()) continue;
      if (thread.kernel) ++urgent.kernel;
      if (!thread.kernel) urgent.foreign.push_back(thread);
    }
  }
  std::stable_sort(urgent.foreign.begin(), urgent.foreign.end(), [](const auto& a, const auto& b) {
    return std::pair(a.ticks, a.priority) > std::pair(b.ticks, b.priority);
  });
  return urgent;
}

}  // namespace

Finding check_throttling(const Facts& facts) {
  const auto runtime = facts.text("proc/sys/kernel/sched_rt_runtime_us");
  const auto period = facts.text("proc/sys/kernel/sched_rt_period_us");
  if (!runtime) return good("not to be read; the admission counts on 95 % a second");
  const std::int64_t its = whole(*runtime);
  const std::int64_t all = period ? std::max<std::int64_t>(whole(*period), 1) : 1'000'000;
  const std::string remedy = "sysctl -w kernel.sched_rt_runtime_us=950000";
  if (its < 0) return good("off: only the guard stops a thread that loops");
  const std::string found = "real-time threads get " + *runtime + " of " + std::to_string(all) +
                            " us of each CPU (sched_rt_runtime_us)";
  if (its == 0) return bad(found, remedy);
  if (its * 100 < all * 95) return doubt(found + "; the admission counts on 95 %", remedy);
  return good(found);
}

Finding check_preemption(const Facts& facts) {
  const std::string version = facts.text("proc/version").value_or("");
  const bool realtime = facts.text("sys/kernel/realtime") == "1";
  if (realtime || version.find("PREEMPT_RT") != std::string::npos) return good("PREEMPT_RT");
  const bool dynamic = version.find("PREEMPT_DYNAMIC") != std::string::npos;
  const std::string model = preemption_of(facts, dynamic);
  const std::string found = dynamic ? "PREEMPT_DYNAMIC, " : "";
  if (model == "full") return good(found + "full; PREEMPT_RT has lower worst cases");
  const std::string remedy =
      dynamic ? std::string("on the kernel's command line: preempt=full; lower worst cases: ") +
                    kGetRealTime
              : std::string(kGetRealTime) + ", then reboot";
  return doubt(found + (model.empty() ? "model not to be read" : model) +
                   ": a system call of somebody else may delay a release by milliseconds",
               remedy);
}

Finding check_foreign(const Facts& facts) {
  const Urgent urgent = urgent_threads(facts);
  const std::string kernel = counted(urgent.kernel, "thread") + " of the kernel";
  if (urgent.foreign.empty()) return good("none, beside " + kernel);
  std::string found;
  std::string remedy;
  std::set<std::string> remedies;
  for (std::size_t i = 0; i < std::min(kNamed, urgent.foreign.size()); ++i) {
    join(found, described(facts, urgent.foreign[i]));
    const std::string its = remedy_for(facts, urgent.foreign[i]);
    if (remedies.insert(its).second) join(remedy, its, "; ");
  }
  if (urgent.foreign.size() > kNamed) {
    found += " and " + std::to_string(urgent.foreign.size() - kNamed) + " more";
  }
  double lowest = 0;
  for (const Json& row : facts.components()) {
    const double priority = number(row, "priority");
    lowest = lowest > 0 ? std::min(lowest, priority) : priority;
  }
  const auto highest = std::ranges::max(urgent.foreign, {}, &rt::ThreadFacts::priority).priority;
  if (highest < lowest) {
    return good(found + ": less urgent than every component");
  }
  return doubt(found, remedy);
}

Finding check_huge_pages(const Facts& facts) {
  const std::string file = "sys/kernel/mm/transparent_hugepage/enabled";
  const auto words = facts.text(file);
  if (!words) return good("the kernel has no transparent ones");
  const std::string mode = chosen(*words, '[', ']');
  if (mode != "always") return good("transparent ones: " + mode);
  return doubt("transparent ones: always; the kernel stops threads to collect pages",
               "echo madvise > /" + file);
}

Finding check_swap(const Facts& facts) {
  const std::string areas = facts.text("proc/swaps").value_or("");
  const auto count = std::count(areas.begin(), areas.end(), '\n');
  if (count == 0) return good("off");
  const std::string found = counted(static_cast<std::uint64_t>(count), "area") + " in use";
  if (whole_number(facts.daemon, "locked_kib") > 0) {
    return good(found + "; the memory of mauved is locked");
  }
  return doubt(found + ", and memory of mauved is not locked", "swapoff --all");
}

}  // namespace mauve::ctl::doctor
