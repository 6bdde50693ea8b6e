// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit/under_way.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include "exec/recovery/probations.h"
#include "exec/recovery/standby.h"
#include "exec/task/safe_values.h"

#include <mauve/host/component.h>

namespace mauve::exec {
namespace {

/// For a task whose thread was abandoned and could not be replaced.
void write_for_tasks_without_thread(System& system) {
  for (Deployed& deployed : system.deployed) {
    if (!deployed.task->take_safe_values_request() || deployed.component == nullptr) continue;
    write_safe_values_on_behalf(*deployed.component->bundle());
  }
}

}  // namespace

/// Probations come first: a stop may make a task forget the rollback that it took. But they wait
/// until the command that made a change has read its generation, which is saved before the next one
/// comes.
void advance(System& system) {
  system.looks.fetch_add(1);
  if (system.stops_obeyed != system.stops.revision()) system.obey_stops();
  if (system.stands_still > 0) return;
  write_for_tasks_without_thread(system);
  if (const ModelLock::Hold hold(system.model, std::try_to_lock); hold) look_after_itself(system);
  std::erase_if(system.under_way, [](const std::shared_ptr<Commit>& commit) {
    static_cast<void>(commit->advance());
    return commit->over();
  });
}

/// A command that has dropped its commit never asks for the result.
bool is_unreported(const System& system) {
  const auto last = system.last_change.lock();
  if (last == nullptr || !last->is_unreported()) return false;
  const bool kept_here =
      std::find(system.under_way.begin(), system.under_way.end(), last) != system.under_way.end();
  return last.use_count() > (kept_here ? 2 : 1);
}

std::shared_ptr<Commit> begin_commit(System& system, PreparedChange& change,
                                     TwoPhaseCommit::Kind kind, Duration longest_job) {
  // An unconditional update was prepared from the present state; a rollback that gets into the
  // books would undo it.
  if (kind == TwoPhaseCommit::Kind::change) advance(system);
  auto commit = std::make_shared<Commit>(system, change.share(), kind, longest_job);
  if (kind == TwoPhaseCommit::Kind::change) system.last_change = commit;
  if (!commit->over()) system.under_way.push_back(commit);
  return commit;
}

void look_after_itself(System& system) {
  if (is_unreported(system)) return;
  for (const auto& one : system.probations) static_cast<void>(one->advance());
  let_fade(system);
  std::erase_if(system.fading, [&](const std::shared_ptr<ProbationPeriod>& one) {
    if (one->advance()) return false;
    system.retired.merge(one->take_retired());
    return true;
  });
  look_after_standby_cores(system);
  system.forget_departed();
}

}  // namespace mauve::exec
