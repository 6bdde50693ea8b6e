// SPDX-License-Identifier: LGPL-3.0-or-later
/// Swap in place: the paper's way, for hardware that only one core can hold at a time.
#include <array>

#include "exec/system.h"
#include "model/elements.h"

#include <mauve/job.h>

namespace mauve {
namespace {

Status configure_pair(const Bundle& bundle) {
  const Detached detached;
  const std::array<Configurable*, 2> order{bundle.core.get(), bundle.fsm.get()};
  return configure_in_order(order);
}

}  // namespace

Result<PreparedChange> Deployer::prepare_in_place(const Edit& edit) {
  return exec::prepare_change(*system_, {{edit}}, false);
}

Status Deployer::in_place_park(PreparedChange& change) {
  exec::PreparedMember& member = change.content().members.front();
  // What the operator had stopped, or what had faulted, stays where it is.
  member.resume = status(member.component->name()).state == ComponentState::running;
  if (!member.resume) return ok();
  PreparedChange park = exec::only_mode(*member.component, Mode::park);
  Retired nothing;
  const Result<Receipt> parked = exec::commit_change(*system_, park, nothing);
  if (!parked) return parked.error();
  member.base = member.component->bundle();
  return ok();
}

Status Deployer::in_place_exchange(PreparedChange& change) {
  const exec::PreparedMember& member = change.content().members.front();
  const std::array<Configurable*, 2> old{member.base->core.get(), member.base->fsm.get()};
  static_cast<void>(cleanup_in_reverse(old));
  Status configured = configure_pair(*member.next);
  if (configured) return ok();
  if (Status back = configure_pair(*member.base); !back) {
    configured.error().message +=
        "; and the old core could not be configured again: " + back.error().message;
    configured.error().code = Errc::wrong_state;
  }
  return configured;
}

Result<Receipt> Deployer::in_place_resume(PreparedChange& change, Status exchanged,
                                          Retired& retired) {
  exec::PreparedMember& member = change.content().members.front();
  const bool old_is_usable = member.base->core->configured();
  if (!exchanged && !old_is_usable) return exchanged.error();
  const Mode mode = member.resume ? Mode::run : Mode::keep;
  PreparedChange back = exec::only_mode(*member.component, mode);
  PreparedChange& resumed = exchanged ? change : back;
  for (exec::PreparedMember& part : resumed.content().members) {
    part.mode = mode;
    part.count_gap = member.resume;
  }
  Result<Receipt> receipt = exec::commit_change(*system_, resumed, retired);
  if (!exchanged) return exchanged.error();
  return receipt;
}

Result<Receipt> Deployer::swap_core_in_place(const Edit& edit) {
  Result<PreparedChange> change = prepare_in_place(edit);
  if (!change) return change.error();
  if (Status parked = in_place_park(*change); !parked) return parked.error();
  Retired retired;
  return in_place_resume(*change, in_place_exchange(*change), retired);
}

}  // namespace mauve
