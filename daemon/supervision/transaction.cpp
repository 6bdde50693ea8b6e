// SPDX-License-Identifier: LGPL-3.0-or-later
#include "supervision/transaction.h"

#include <algorithm>
#include <iterator>

#include "arch/parse/transaction.h"
#include "base/thread_role.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/say.h"
#include "commands/stops.h"

namespace mauve::daemon {

namespace {

/// Rolls back a change that waits for its confirmation and shares a component with this
/// one. A change that only stops or starts components does not need that.
bool rolls_back_unconfirmed(Running& running, const Change& change,
                            const std::string& transaction) {
  if (only_starts_and_stops(running, change)) {
    return false;
  }
  const auto shares = [&change](const OpenProbation& open) {
    return std::ranges::any_of(change.edits, [&open](const Edit& edit) {
      return std::ranges::find(open.components, edit.member) != open.components.end();
    });
  };
  for (const auto& open : running.deployer.probations()) {
    const bool waits = open.rules.confirm_within > Duration{0} && !open.rolls_back;
    if (waits && shares(open)) {
      return running.deployer
          .undo("not confirmed before " + transaction + " began", open.generations)
          .has_value();
    }
  }
  return false;
}

/// The answer names the components that the transaction does not start, because a user stopped
/// them.
class StaysStopped final : public ChangeHooks {
 public:
  explicit StaysStopped(std::vector<std::string> notes) : notes_(std::move(notes)) {}
  Status check_prepared(PreparedChange& /*change*/) override { return ok(); }
  void in_force(std::uint64_t /*generation*/) override {}
  void complete(Json& result) override { say_notes(notes_, result); }

 private:
  std::vector<std::string> notes_;
};

}  // namespace

bool brings_something_new(const rules::Steps& steps) {
  return std::ranges::any_of(steps, [](const rules::Step& step) {
    return step.action == rules::Action::swap || step.action == rules::Action::set;
  });
}

std::vector<std::string> subjects_of(const rules::Steps& steps) {
  std::vector<std::string> names;
  std::ranges::transform(steps, std::back_inserter(names), &rules::Step::subject);
  return names;
}

Change change_that_parks(const std::vector<std::string>& components) {
  Change change;
  for (const auto& component : components) {
    change.edits.push_back(edit_of(component));
    change.edits.back().mode = Mode::park;
  }
  return change;
}

void begin_transaction(Running& running, const CallPtr& call, const rules::Steps& steps,
                       Ticket ticket) {
  MAUVE_ON_THREAD(control);
  auto change = arch::change_of(steps, running.architecture, running.deployer, running.catalog);
  if (!change) {
    return answer(running, *call, change.error());
  }
  const auto notes = leave_stopped(running, *change);
  if (change->edits.empty()) {
    auto result = to_json(Receipt{running.generation, {}, {}, 0, {}});
    say_notes(notes, result);
    return answer(running, *call, std::move(result));
  }
  if (const auto may = may_prepare_change(running, *change, std::nullopt); !may) {
    return answer(running, *call, may.error());
  }
  if (only_stops(*change) ||
      !rolls_back_unconfirmed(running, *change, text_or(call->params, "transaction"))) {
    return apply(running, call, std::move(ticket), *std::move(change),
                 notes.empty() ? nullptr : std::make_shared<StaysStopped>(notes));
  }
  running.control.await([&running] { return !running.deployer.going_back(); },
                        [&running, call, steps, ticket = std::move(ticket)]() mutable {
                          const FromLookToAct still(running);
                          begin_transaction(running, call, steps, std::move(ticket));
                        });
}

}  // namespace mauve::daemon
