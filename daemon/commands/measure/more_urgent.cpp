// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/measure/more_urgent.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <tuple>

#include "monitor/own_job.h"

namespace mauve::daemon {

namespace {

using Components = std::vector<const ComponentStatus*>;

bool shares_a_cpu(const ComponentStatus& one, const ComponentStatus& other) {
  return one.cpus.empty() || other.cpus.empty() ||
         std::any_of(one.cpus.begin(), one.cpus.end(), [&](int cpu) {
           return std::find(other.cpus.begin(), other.cpus.end(), cpu) != other.cpus.end();
         });
}

/// With an equal priority, a job that began first runs until it ends.
bool goes_before(const ComponentStatus& one, const ComponentStatus& late) {
  return one.name != late.name && one.realtime && shares_a_cpu(one, late) &&
         (!late.realtime || one.priority >= late.priority);
}

bool exceeded_budget(const ComponentStatus& one) {
  return one.over_present_budget > 0 && one.budget > Duration{0} && one.used_max > one.budget;
}

/// "49.7 ms": as mauvectl writes the other times of the answer.
std::string in_words(Duration duration) {
  const auto count = static_cast<double>(duration.count());
  const auto [unit, name] = count < 1e3   ? std::pair(1.0, "ns")
                            : count < 1e6 ? std::pair(1e3, "us")
                            : count < 1e9 ? std::pair(1e6, "ms")
                                          : std::pair(1e9, "s");
  const bool whole = unit < 1e3 || count / unit >= 100;
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f %s", whole ? 0 : 1, count / unit, name);
  return text.data();
}

std::string step_to(const ComponentStatus& one, const ComponentStatus& late) {
  const bool equal = late.realtime && one.priority == late.priority;
  const std::string step = "mauvectl why " + one.name + ": it is " +
                           (equal ? "as urgent" : "more urgent") + " on the same CPU, and ";
  if (one.late > Duration{0}) {
    return step + "its job should have ended " + in_words(one.late) + " ago";
  }
  if (exceeded_budget(one)) {
    const auto over = one.over_present_budget;
    return step + std::to_string(over) + (over == 1 ? " job" : " jobs") +
           " exceeded its budget of " + in_words(one.budget) + " (longest " +
           in_words(one.used_max) + " of processor time)";
  }
  const auto* const within = one.used_max > one.budget ? "" : ", within its budget";
  return step + "its longest job (" + in_words(one.used_max) + " of processor time" +
         (one.budget == Duration{0} ? ", no budget" : within) +
         ") leaves too little of a period of " + in_words(late.period);
}

/// By the processor time of one job of each: on the clock, each contains the other. A late
/// component whose own job is too long fills its period alone, so that another one is not to blame.
bool leaves_too_little(const ComponentStatus& one, const ComponentStatus& late) {
  return one.used_max > Duration{0} && late.period > Duration{0} && !own_job_too_long(late) &&
         one.used_max + late.used_max > late.period;
}

std::string own_job_hint(const ComponentStatus& late) {
  const bool over = late.budget > Duration{0} && late.used_max > late.budget;
  return "mauvectl stats " + late.name + ": its own job is too long: up to " +
         in_words(late.used_max) + " of processor time, " +
         (over ? "its budget is " + in_words(late.budget)
               : "its period is " + in_words(late.period));
}

/// The steps that concern the late component alone.
std::vector<std::string> own_hints(const ComponentStatus& late) {
  std::vector<std::string> hints;
  if (own_job_too_long(late)) {
    hints.push_back(own_job_hint(late));
  }
  if (!late.realtime) {
    hints.push_back(
        "mauvectl doctor: this component runs on an ordinary thread, which other "
        "programs delay");
  }
  return hints;
}

}  // namespace

std::vector<std::string> more_urgent_hints(const ComponentStatus& late,
                                           const std::vector<ComponentStatus>& all) {
  Components suspects;
  const ComponentStatus* longest_one = nullptr;
  for (const auto& one : all) {
    if (!goes_before(one, late)) {
      continue;
    }
    if (one.late > Duration{0} || exceeded_budget(one)) {
      suspects.push_back(&one);
    } else if (leaves_too_little(one, late) &&
               (longest_one == nullptr || one.used_max > longest_one->used_max)) {
      longest_one = &one;
    }
  }
  std::stable_sort(suspects.begin(), suspects.end(), [](const auto* a, const auto* b) {
    const auto rank = [](const ComponentStatus& one) {
      return std::tuple(one.late, one.used_max - one.budget);
    };
    return rank(*a) > rank(*b);
  });
  if (suspects.empty() && longest_one != nullptr) {
    suspects.push_back(longest_one);
  }
  auto hints = own_hints(late);
  for (const auto* one : suspects) {
    hints.push_back(step_to(*one, late));
  }
  return hints;
}

}  // namespace mauve::daemon
