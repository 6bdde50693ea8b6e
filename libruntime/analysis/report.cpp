// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/report.h"

#include <algorithm>

#include "base/duration.h"

namespace mauve::analysis {
namespace {

constexpr Duration kMicrosecond = 1us;

/// The third digit of a value, at least a microsecond: the precision that messages show.
Duration third_digit(Duration value) {
  Duration digit = kMicrosecond;
  while (value >= 1000 * digit) digit *= 10;
  return digit;
}

/// For people, who may write it into a file: `value` or a little more.
std::string above(Duration value) {
  const Duration rest = value % third_digit(value);
  return format_duration(rest > Duration{0} ? value - rest + third_digit(value) : value);
}

/// `value` or a little less.
std::string below(Duration value) { return format_duration(rounded_down(value)); }

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// A hint; empty: the holding times of all resources are known.
std::string what_to_declare(const std::vector<std::string>& resources) {
  if (resources.empty()) return "";
  return "; whole jobs count as blocking, declare \"lock_budget\" for " +
         (resources.size() == 1 ? "resource " : std::string("resources ")) + joined(resources);
}

std::string what_would_pass(const JobReport& job) {
  std::string text;
  if (job.needed_deadline() > Duration{0}) {
    text = "a deadline of " + above(job.needed_deadline());
  }
  if (job.needed_execution >= kMicrosecond) {
    text += text.empty() ? "" : " or ";
    text += "an execution time of " + below(job.needed_execution);
  }
  return text.empty() ? "give it a higher priority, or less work to those above it"
                      : text + " would pass";
}

Problem late(const TaskReport& task, const JobReport& job) {
  const std::string end = job.response == kUnbounded
                              ? "may never end"
                              : "may end " + above(job.response) + " after its release";
  const std::string aside = what_to_declare(task.guessed);
  return {
      Problem::Kind::late,
      refuse({Errc::limit, "deadline_not_met"}, task.name,
             "its job " + name(job.job) + " " + end + ", its deadline is " + below(job.deadline),
             what_would_pass(job) + aside),
      aside};
}

void find(const TaskReport& task, std::vector<Problem>& found) {
  if (task.source == Source::unknown) {
    found.push_back(
        {Problem::Kind::unknown,
         refuse({Errc::limit, "execution_time_unknown"}, task.name,
                "the execution time of a job is not known", "declare a budget, or measure it"),
         {}});
  }
  if (!task.cpu) {
    found.push_back({Problem::Kind::floating,
                     refuse({Errc::limit, "cpu_not_pinned"}, task.name,
                            "it may run on several CPUs, so no response time can be proved",
                            "pin it to one CPU"),
                     {}});
  }
  if (task.late()) found.push_back(late(task, *task.tightest()));
}

}  // namespace

Duration rounded_down(Duration value) { return value - value % third_digit(value); }

bool TaskReport::late() const {
  return std::any_of(jobs.begin(), jobs.end(), [](const JobReport& job) { return job.late(); });
}

const JobReport* TaskReport::tightest() const {
  const auto found = std::min_element(
      jobs.begin(), jobs.end(),
      [](const JobReport& a, const JobReport& b) { return a.slack() < b.slack(); });
  return found == jobs.end() ? nullptr : &*found;
}

bool Report::passes() const {
  return std::none_of(tasks.begin(), tasks.end(), [](const TaskReport& t) { return t.late(); }) &&
         std::none_of(cpus.begin(), cpus.end(), [](const CpuReport& c) { return c.overloaded; });
}

bool Report::proven() const {
  return passes() && cross_cpu.empty() &&
         std::none_of(tasks.begin(), tasks.end(), [](const TaskReport& task) {
           return task.source == Source::unknown || !task.cpu;
         });
}

std::vector<Problem> problems(const Report& report) {
  std::vector<Problem> found;
  for (const TaskReport& task : report.tasks) find(task, found);
  for (const CpuReport& cpu : report.cpus) {
    if (!cpu.overloaded) continue;
    found.push_back(
        {Problem::Kind::overloaded,
         refuse({Errc::limit, "cpu_overbooked"}, "cpu " + std::to_string(cpu.cpu),
                "its tasks may ask for " + above(cpu.busiest_second) +
                    " of its time in a second, " + format_duration(kSecondLimit) + " are allowed",
                "take " + above(cpu.busiest_second - kSecondLimit) + " off that"),
         {}});
  }
  for (const SharedReport& shared : report.cross_cpu) {
    found.push_back({Problem::Kind::cross_cpu,
                     refuse({Errc::limit, "lock_across_cpus"}, shared.resource,
                            "its lock is shared across CPUs, by " + joined(shared.tasks),
                            "put them on one CPU"),
                     {}});
  }
  return found;
}

}  // namespace mauve::analysis
