// SPDX-License-Identifier: LGPL-3.0-or-later
/// change.apply: steps as those of a transaction in an architecture file, all at one instant.
#include "arch/build/check_steps.h"
#include "arch/parse/parse_rules.h"
#include "arch/parse/transaction.h"
#include "arch/text/json.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/change/policies.h"
#include "commands/change/stop.h"
#include "commands/model.h"
#include "commands/path_rule.h"
#include "commands/recovery/abandoned.h"
#include "commands/stops.h"

namespace mauve::daemon {

namespace {

rules::Steps steps_of(const Running& running, const std::string& text, arch::Problems& problems) {
  arch::TransactionSpec wanted;
  const auto node = arch::parse_json(text, problems);
  if (node) {
    arch::read_change({*node, "change", problems}, wanted);
  }
  if (problems.empty()) {
    const arch::Spec none;  // the steps concern the running system
    arch::check_steps(wanted, "change", {none, running.architecture, running.catalog}, problems);
  }
  rules::Steps steps;
  for (auto& spec : wanted.steps) {
    steps.push_back(std::move(spec.step));
  }
  return steps;
}

void refuse_steps(Running& running, const Call& call, const arch::Problems& problems) {
  refuse_text(running, call, "the steps have",
              "all steps are those of a transaction: disconnect, connect, swap, set, stop, start",
              to_json(problems));
}

/// A request is refused where a reaction to a fault would lose a state or a value.
void keep_values_and_states(const Running& running, StatePolicy policy, Change& change) {
  for (auto& edit : change.edits) {
    edit.allows = path_rule(running.path_dirs);
    edit.values = Values::keep;
    if (edit.state != StatePolicy::drop) {
      edit.state = policy;
    }
  }
}

/// The components that a user names to stop them, also those that stand already.
std::vector<std::string> stopped_by(const rules::Steps& steps) {
  std::vector<std::string> names;
  for (const auto& step : steps) {
    if (step.action == rules::Action::stop) {
      names.push_back(step.subject);
    }
  }
  return names;
}

}  // namespace

void change_steps(Running& running, const CallPtr& call, Ticket ticket) {
  const auto policy = state_policy(call->params);
  if (!policy) {
    return answer(running, *call, policy.error());
  }
  arch::Problems problems;
  const auto steps = steps_of(running, text_or(call->params, "text"), problems);
  if (!problems.empty()) {
    return refuse_steps(running, *call, problems);
  }
  auto change = arch::change_of(steps, running.architecture, running.deployer, running.catalog);
  if (!change) {
    return answer(running, *call, change.error());
  }
  change->stops = stopped_by(steps);
  change->stopped_by = stop_by(*call);
  const bool dry_run = flag(call->params, "dry_run");
  if (change->edits.empty() && !change->stops.empty() && !dry_run) {
    return stop_only(running, call, std::move(ticket), *change);
  }
  if (change->edits.empty()) {
    return answer(running, *call, to_json(Receipt{running.generation, {}, {}, 0, {}}));
  }
  if (auto allowed = may_prepare_change(running, *change, call->caller.peer.uid); !allowed) {
    return answer(running, *call, allowed.error());
  }
  change->ends_stops = true;  // a user names what he starts
  keep_values_and_states(running, *policy, *change);
  apply(running, call, std::move(ticket), *std::move(change));
}

}  // namespace mauve::daemon
