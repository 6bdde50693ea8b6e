// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/prepare/foresee.h"

#include "base/thread_role.h"

#include <algorithm>

#include "exec/commit/commit.h"
#include "exec/recovery/inherit.h"
#include "exec/system/books.h"
#include "model/element/hand_over.h"

#include <mauve/host/receipt.h>
#include <mauve/host/resource.h>

namespace mauve::exec {
namespace {

/// The fate of the state when one core replaces the other.
MemberReceipt row_of(const std::string& name, const CoreBase& from, const CoreBase& into,
                     StatePolicy policy) {
  MemberReceipt row{name, Duration{0}, 0, 0};
  if (&from == &into) return row;
  const auto plan = plan_hand_over(from, into, policy);
  if (plan) row.bytes = plan->bytes;
  say_states(from, into, policy, row);
  return row;
}

/// Those that would wait at a barrier may lose releases.
void add_waits(const PreparedBarrier& barrier, Receipt& receipt) {
  for (const auto& wait : barrier.waits) {
    const auto row = std::find_if(receipt.components.begin(), receipt.components.end(),
                                  [&](const auto& one) { return one.name == wait.component; });
    if (row != receipt.components.end()) {
      row->missed = wait.releases;
    } else {
      receipt.components.push_back({wait.component, Duration{0}, wait.releases, 0});
    }
  }
}

}  // namespace

Receipt foresee(const System& system, const PreparedChange::Content& content) {
  MAUVE_ON_THREAD(control);
  Receipt receipt;
  receipt.generation = system.generation;
  for (const auto& member : content.members) {
    receipt.components.push_back(
        row_of(member.component->name(), *member.base->core, *member.next->core, member.state));
  }
  for (const auto& resource : content.resources) {
    if (resource.parts.core == nullptr) continue;
    receipt.components.push_back(row_of(resource.resource->name(), *resource.base.core,
                                        *resource.parts.core, resource.state));
  }
  if (content.barrier) {
    for (const auto& one : content.barrier->replacements) {
      MemberReceipt row{one.into->name(), Duration{0}, 0, 0};
      say_replaced(*one.from, *one.into, one.state, row);
      receipt.components.push_back(std::move(row));
    }
    add_waits(*content.barrier, receipt);
  }
  receipt.warnings = content.warnings;
  receipt.notes = notes_of(system, content);
  return receipt;
}

}  // namespace mauve::exec
