// SPDX-License-Identifier: LGPL-3.0-or-later
/// The machine: clock, frequency, CPUs set apart, sleep states, a host below.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "doctor/checks.h"
#include "render/words.h"

namespace mauve::ctl::doctor {
namespace {

constexpr std::int64_t kLongestWaking = 20;          // us, out of a sleep state
constexpr std::int64_t kNobodyAsks = 2'000'000'000;  // us, the kernel's value for that
constexpr std::size_t kEnoughCpus = 4;               // to set some apart
constexpr double kHardlyStolen = 0.01;               // %, a tick now and then since the boot
const std::string kCpus = "sys/devices/system/cpu/";

/// The longest wake-up time, in us, that a process requires of the machine. Nothing is returned
/// when only root may read it.
std::optional<std::int64_t> latency_asked(const Facts& facts) {
  std::ifstream device(facts.root / "dev/cpu_dma_latency", std::ios::binary);
  char bytes[sizeof(std::int32_t)];
  if (!device.read(bytes, sizeof bytes)) return std::nullopt;
  std::int32_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// The longest time that a permitted sleep state takes to end; -1 when there is none.
std::int64_t longest_waking(const Facts& facts, std::int64_t asked) {
  std::int64_t longest = -1;
  for (const std::string& cpu : facts.cpu_folders()) {
    const std::string folder = kCpus + cpu + "/cpuidle/";
    for (const std::string& state : facts.names(folder)) {
      const auto latency = facts.text(folder + state + "/latency");
      if (!latency || facts.text(folder + state + "/disable") == "1") continue;
      const std::int64_t its = whole(*latency);
      if (its <= asked) longest = std::max(longest, its);
    }
  }
  return longest;
}

/// CPUs that components run on, and whether some may run anywhere.
struct Used {
  std::set<int> cpus;
  std::string anywhere;
};

Used used_cpus(const Facts& facts) {
  Used used;
  for (const Json& row : facts.components()) {
    const Json& cpus = list_in(row, "cpus");
    if (cpus.empty()) join(used.anywhere, word(row, "name"));
    for (const Json& cpu : cpus) {
      if (cpu.is_number_integer()) used.cpus.insert(cpu.get<int>());
    }
  }
  return used;
}

/// In the first set and not in the second.
std::vector<int> without(const std::set<int>& all, const std::vector<int>& excluded) {
  std::vector<int> rest;
  for (const int cpu : all) {
    if (std::find(excluded.begin(), excluded.end(), cpu) == excluded.end()) rest.push_back(cpu);
  }
  return rest;
}

std::string boot_line(const std::string& cpus) {
  return "on the kernel's command line: isolcpus=managed_irq,domain," + cpus +
         " nohz_full=" + cpus + " rcu_nocbs=" + cpus;
}

/// Programs do not inherit isolated CPUs, so mauved refuses a file that names one unless its unit
/// permits it. The unit permits all: the scheduler moves no ordinary thread to an isolated CPU.
std::string permit_all(const Facts& facts) {
  const std::size_t count = std::max<std::size_t>(facts.cpu_folders().size(), 1);
  return "`systemctl edit mauved`: [Service] CPUAffinity=0-" + std::to_string(count - 1) +
         " (otherwise mauved refuses a file that names an isolated CPU)";
}

/// A component on an isolated CPU shows that the unit permits them.
std::string place_remedy(const Facts& facts, const Used& used, const std::vector<int>& isolated,
                         int cpu) {
  const bool permitted = without(used.cpus, isolated).size() < used.cpus.size();
  return (permitted ? "" : permit_all(facts) + ", then restart it; ") +
         "in the architecture file, for each of them: \"task\": {\"cpus\": [" +
         std::to_string(cpu) + "]}";
}

Finding judge_isolated(const Facts& facts, const Used& used, const std::vector<int>& isolated) {
  const std::string found = "CPU " + cpu_list(isolated) + " set apart";
  const auto beside = without(used.cpus, isolated);
  if (!beside.empty() && !facts.status.is_null()) {
    return doubt(found + ", but components run on CPU " + cpu_list(beside),
                 place_remedy(facts, used, isolated, isolated.front()));
  }
  const std::set<int> all(isolated.begin(), isolated.end());
  const auto idle = without(all, {used.cpus.begin(), used.cpus.end()});
  if (!idle.empty() && !used.cpus.empty()) {
    return doubt(
        found + ", but no component uses CPU " + cpu_list(idle) + ", and no other program may",
        place_remedy(facts, used, isolated, idle.front()));
  }
  const auto full = cpus_in(facts.text(kCpus + "nohz_full").value_or(""));
  if (const auto ticking = without(all, full); !ticking.empty()) {
    return doubt(
        found + ", but with a timer tick on CPU " + cpu_list(ticking) + ", which interrupts jobs",
        boot_line(cpu_list(isolated)));
  }
  return good(found + ", without a timer tick");
}

struct Share {
  double stolen = 0;
  double all = 0;
};

/// "cpu  user nice system idle iowait irq softirq steal guest guest_nice"; guests are in user.
Share stolen_time(const std::string& stat) {
  std::istringstream words(stat.substr(0, stat.find('\n')));
  std::string name;
  words >> name;
  Share share;
  double ticks = 0;
  for (int i = 0; i < 8 && words >> ticks; ++i) {
    share.all += ticks;
    if (i == 7) share.stolen = ticks;
  }
  return share;
}

}  // namespace

Finding check_clock(const Facts& facts) {
  const std::string folder = "sys/devices/system/clocksource/clocksource0/";
  const auto source = facts.text(folder + "current_clocksource");
  if (!source) return doubt("not to be read", "cat /" + folder + "current_clocksource");
  static const std::set<std::string> kFast = {"tsc", "kvm-clock", "arch_sys_counter",
                                              "hyperv_clocksource_tsc_page"};
  if (kFast.contains(*source)) return good(*source);
  const std::string found = *source + ": each reading is a system call, or slower";
  const std::string others = facts.text(folder + "available_clocksource").value_or("");
  const bool has_tsc = (" " + others + " ").find(" tsc ") != std::string::npos;
  return doubt(found, has_tsc ? "echo tsc > /" + folder + "current_clocksource"
                              : "on the kernel's command line: tsc=reliable, where the CPU "
                                "has a constant one (constant_tsc in /proc/cpuinfo)");
}

Finding check_frequency(const Facts& facts) {
  std::string slow;
  std::size_t scaled = 0;
  for (const std::string& cpu : facts.cpu_folders()) {
    const auto governor = facts.text(kCpus + cpu + "/cpufreq/scaling_governor");
    if (!governor) continue;
    ++scaled;
    if (*governor == "performance") continue;
    join(slow, cpu + " " + *governor);
  }
  if (scaled == 0) return good("the system does not change it");
  if (slow.empty()) return good("performance on " + counted(scaled, "CPU"));
  return doubt("the governor lowers it, and jobs take longer then: " + slow,
               "echo performance | tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
}

Finding check_isolation(const Facts& facts) {
  const auto isolated = cpus_in(facts.text(kCpus + "isolated").value_or(""));
  const Used used = used_cpus(facts);
  if (!isolated.empty() && !used.anywhere.empty()) {
    return doubt("CPU " + cpu_list(isolated) + " set apart, but not for " + used.anywhere,
                 place_remedy(facts, used, isolated, isolated.front()));
  }
  if (!isolated.empty()) return judge_isolated(facts, used, isolated);
  const std::size_t count = facts.cpu_folders().size();
  if (count < kEnoughCpus) return good("none of " + counted(count, "CPU") + ", too few for it");
  if (facts.status.is_null()) return good("none of " + counted(count, "CPU"));
  const std::string theirs = cpu_list({used.cpus.begin(), used.cpus.end()});
  if (theirs.empty()) return good("none, and no component is bound to a CPU");
  if (used.cpus.size() == count) return good("none: components use all CPUs");
  return doubt("none; components share CPU " + theirs + " with everything else",
               permit_all(facts) + "; then " + boot_line(theirs));
}

Finding check_sleep(const Facts& facts) {
  const auto asked = latency_asked(facts);
  const std::int64_t longest = longest_waking(facts, asked.value_or(INT32_MAX));
  const std::string held = asked && *asked < kNobodyAsks
                               ? "/dev/cpu_dma_latency is " + std::to_string(*asked) + " us"
                               : "";
  if (longest < 0) return good(held.empty() ? "none" : "none is permitted, " + held);
  std::string found = "waking up takes at most " + std::to_string(longest) + " us";
  if (!held.empty()) found += ", " + held;
  if (longest <= kLongestWaking) return good(found);
  return doubt(found,
               "for s in /sys/devices/system/cpu/cpu*/cpuidle/state*; do [ $(cat $s/latency) -le " +
                   std::to_string(kLongestWaking) + " ] || echo 1 > $s/disable; done");
}

Finding check_virtual(const Facts& facts) {
  const std::string cpus = facts.text("proc/cpuinfo").value_or("");
  const bool host = cpus.find(" hypervisor") != std::string::npos;
  const Share time = stolen_time(facts.text("proc/stat").value_or(""));
  if (time.stolen <= 0) return good(host ? "yes, but its host took no time" : "no");
  const double percent = 100 * time.stolen / time.all;
  if (percent < kHardlyStolen) return good("yes, but its host took less than 0.01 % of all time");
  char share[32];
  std::snprintf(share, sizeof share, "%.2f %%", percent);
  return doubt("its host took " + std::string(share) + " of all time since it was started",
               "give each virtual CPU a CPU of the host (virsh vcpupin DOMAIN VCPU CPU), or run "
               "mauved without a host");
}

}  // namespace mauve::ctl::doctor
