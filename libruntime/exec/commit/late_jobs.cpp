// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit/late_jobs.h"

#include <optional>

#include "exec/task/task.h"

namespace mauve::exec {
namespace {

std::string milliseconds(Duration duration) { return std::to_string(duration / 1ms) + " ms"; }

}  // namespace

LateJobs::LateJobs(const Runner& runner, const std::vector<Deployed*>& members)
    : runner_(runner), since_(runner.now()) {
  for (const Deployed* member : members) {
    const auto ran = runner.processor_time(*member->task);
    if (ran) ran_before_[member->task.get()] = *ran;
  }
}

std::string LateJobs::reason(const std::vector<Deployed*>& silent) const {
  std::string reasons;
  for (const Deployed* member : silent) {
    const std::string why = reason(*member);
    if (why.empty()) continue;
    reasons += "; " + (silent.size() > 1 ? member->task->name() + ": " : "") + why;
  }
  return reasons;
}

std::string LateJobs::reason(const Deployed& member) const {
  const auto before = ran_before_.find(member.task.get());
  const std::optional<Duration> ran = runner_.processor_time(*member.task);
  // Another thread goes on with the task of an abandoned one, and has run for less.
  if (before == ran_before_.end() || !ran || *ran < before->second) return {};
  const Duration waited{runner_.now() - since_};
  return reason_of_delay(*ran - before->second, runner_.is_asleep(*member.task), waited);
}

std::string reason_of_delay(Duration ran, bool asleep, Duration waited) {
  const std::string share = milliseconds(ran) + " of the last " + milliseconds(waited);
  if (2 * ran >= waited) return "its thread ran for " + share + ", so the job does not return";
  if (asleep) return "its thread ran for " + share + " and sleeps in a call of the job";
  return "its thread got a processor for " + share +
         ", so other threads or the host delay it, not its core";
}

}  // namespace mauve::exec
