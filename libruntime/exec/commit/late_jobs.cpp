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
    if (const auto use = runner.use_of(*member->task)) ran_before_[member->task.get()] = use->ran;
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
  std::optional<ThreadUse> use = runner_.use_of(*member.task);
  // Another thread goes on with the task of an abandoned one, and has run for less.
  if (before == ran_before_.end() || !use || use->ran < before->second) return {};
  use->ran -= before->second;
  return reason_of_delay(*use, Duration{runner_.now() - since_});
}

std::string reason_of_delay(const ThreadUse& used, Duration waited) {
  const std::string share = milliseconds(used.ran) + " of the last " + milliseconds(waited);
  if (2 * used.ran >= waited) return "its thread ran for " + share + ", so the job does not return";
  if (used.asleep) return "its thread ran for " + share + " and sleeps in a call of the job";
  return "its thread got a processor for " + share +
         ", so other threads or the host delay it, not its core";
}

}  // namespace mauve::exec
