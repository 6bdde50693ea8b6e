// SPDX-License-Identifier: LGPL-3.0-or-later
#include "supervision/transaction.h"

#include <algorithm>

#include "arch/parse/transaction.h"
#include "base/thread_role.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/recovery/abandoned.h"

namespace mauve::daemon {

namespace {

/// Rolls back a change that waits for its confirmation and shares a component with this
/// one. A change that only stops or starts components does not need that.
bool rolls_back_unconfirmed(Running& running, const Change& change,
                            const std::string& transaction) {
  if (changes_modes_only(running, change)) {
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
          .undo("not confirmed before " + transaction + " began", open.generations.back())
          .has_value();
    }
  }
  return false;
}

}  // namespace

void begin_transaction(Running& running, const CallPtr& call, const rules::Steps& steps,
                       Ticket ticket) {
  MAUVE_ON_THREAD(control);
  auto change = arch::change_of(steps, running.architecture, running.deployer, running.catalog);
  if (!change) {
    return answer(running, *call, change.error());
  }
  if (change->edits.empty()) {
    return answer(running, *call, to_json(Receipt{running.generation, {}, {}, 0, {}}));
  }
  if (const auto may = may_prepare_change(running, *change, std::nullopt); !may) {
    return answer(running, *call, may.error());
  }
  if (!rolls_back_unconfirmed(running, *change, text_or(call->params, "transaction"))) {
    return apply(running, call, std::move(ticket), *std::move(change));
  }
  running.control.await([&running] { return !running.deployer.going_back(); },
                        [&running, call, steps, ticket = std::move(ticket)]() mutable {
                          running.report_outcomes();
                          begin_transaction(running, call, steps, std::move(ticket));
                        });
}

}  // namespace mauve::daemon
