// SPDX-License-Identifier: LGPL-3.0-or-later
/// The books: the updates of the model, the scheduler and the receipt at a commit and at a
/// rollback.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "exec/system/system.h"

#include <mauve/host/change_policy.h>
#include <mauve/result.h>

namespace mauve {
class Architecture;
class CoreBase;
class ResourceBase;
class Retired;
struct Bundle;
struct MemberReceipt;
struct NewFallback;
}  // namespace mauve

namespace mauve::exec {

/// Would the change start the member, although a user has stopped it? Then it stays stopped.
/// [control]
[[nodiscard]] bool stays_stopped(const System& system, const PreparedChange::Content& change,
                                 const PreparedMember& member);

/// The change is not put in force: its stops end where none stood before. [control]
void take_back_stops(System& system, const PreparedChange::Content& change);

[[nodiscard]] Error being_rolled_back(std::uint64_t generation);

/// The elements of `old` that `now` does not use, in the order of dependency.
void retire(const Bundle& old, const Bundle& now, Retired& retired);

/// Gives the thread the priority and the CPUs of its committed bundle. [control]
void schedule(System& system, Deployed& deployed);

/// Enters the states that were converted, those that no core took, and a core without a state into
/// the receipt of a member.
void say_states(const CoreBase& from, const CoreBase& into, StatePolicy policy, MemberReceipt& row);

/// Adds a note for each state whose description has no fields, so that only its name and size were
/// compared.
void note_unexamined(const std::string& at, const CoreBase& from, const CoreBase& into,
                     StatePolicy policy, std::vector<std::string>& notes);

/// Adds a note when the new core begins fresh because the core before does not say whether it has a
/// state. A change to another core, and a reload, are not refused for that: they ask for new code.
void note_fresh(const std::string& at, const CoreBase& from, const CoreBase& into,
                StatePolicy policy, std::vector<std::string>& notes);

/// Adds a note when the rollback from `now` to `before` cannot hand the state over: `before` has no
/// converter from it, or declares no state. `before` then continues with its state from before the
/// change.
void note_one_way(const std::string& at, const CoreBase& now, const CoreBase& before,
                  StatePolicy policy, std::vector<std::string>& notes);

/// Adds a note when a resource that is replaced hands its data over: its rollback continues with
/// the data that the old resource keeps.
void note_replaced(const ResourceBase& from, const ResourceBase& into, StatePolicy policy,
                   std::vector<std::string>& notes);

/// Enters the data that a replaced resource converts, drops or hands over into the receipt.
void say_replaced(const ResourceBase& from, const ResourceBase& into, StatePolicy policy,
                  MemberReceipt& row);

/// Exchanges the fallback cores of components with these.
void exchange_fallbacks(Architecture& architecture, std::vector<NewFallback>& fallbacks);

}  // namespace mauve::exec
