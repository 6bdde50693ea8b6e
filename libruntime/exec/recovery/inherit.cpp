// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/recovery/inherit.h"

#include "base/number_list.h"
#include "base/thread_role.h"

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string_view>
#include <utility>

#include "exec/recovery/probation_period.h"
#include "exec/swap/bystanders.h"
#include "exec/swap/rewired.h"
#include "exec/system/books.h"
#include "model/element/hand_over.h"

#include <mauve/fsm.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve::exec {
namespace {

using Content = PreparedChange::Content;
using Names = std::set<std::string, std::less<>>;

/// Everything that the change makes different, by name: a name that left may be there anew.
Names names_of(const Content& change) {
  Names names;
  for (const PreparedMember& member : change.members) names.insert(member.component->name());
  for (const PreparedResource& one : change.resources) names.insert(one.resource->name());
  for (const auto& resource : change.new_resources) names.insert(resource->name());
  for (const ResourceBase* resource : change.leaving_resources) names.insert(resource->name());
  for (const NewFallback& fallback : change.fallbacks) names.insert(fallback.component);
  return names;
}

bool has_resources(const Content& change) {
  return !change.resources.empty() || !change.new_resources.empty() ||
         !change.leaving_resources.empty();
}

using Resources = std::set<const ResourceBase*>;

bool leads_into(const Bundle& bundle, const Resources& resources) {
  return std::any_of(bundle.bindings->begin(), bundle.bindings->end(), [&](const auto& binding) {
    return binding != nullptr && resources.contains(&binding->service().resource());
  });
}

bool any_leads_into(const Content& change, const Resources& resources) {
  return std::any_of(change.members.begin(), change.members.end(), [&](const auto& member) {
    return leads_into(*member.base, resources) || leads_into(*member.next, resources);
  });
}

bool same_names(const System& system, const Content& change, const Names& before) {
  const Names names = names_of(change);
  const bool shared = std::any_of(names.begin(), names.end(),
                                  [&](const std::string& name) { return before.contains(name); });
  if (shared || !change.barrier) return shared;
  // A member that waits at a barrier cannot be rolled back meanwhile.
  const auto bystanders = bystanders_of(system, change);
  return std::any_of(bystanders.begin(), bystanders.end(), [&](const ComponentBase* component) {
    return before.contains(component->name());
  });
}

const std::shared_ptr<Configurable>* find(const std::vector<std::shared_ptr<Configurable>>& all,
                                          const Configurable* one) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [one](const auto& element) { return element.get() == one; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::shared_ptr<Configurable>> elements_of(const Bundle& bundle) {
  return {bundle.shell, bundle.core, bundle.fsm};
}

/// Retires the elements of `between` that none of the others has.
void retire_between(const Bundle& between, std::initializer_list<const Bundle*> others,
                    Retired& retired) {
  for (auto& element : elements_of(between)) {
    const bool needed = std::any_of(others.begin(), others.end(), [&](const Bundle* other) {
      return other != nullptr && find(elements_of(*other), element.get()) != nullptr;
    });
    if (!needed) retired.add(std::move(element));
  }
}

template <typename T>
void put_before(std::vector<T>& into, std::vector<T>& from) {
  into.insert(into.begin(), std::make_move_iterator(from.begin()),
              std::make_move_iterator(from.end()));
  from.clear();
}

void adopt_fallbacks(Content& before, Content& heir) {
  for (NewFallback& older : before.fallbacks) {
    std::erase_if(heir.fallbacks,
                  [&](const NewFallback& one) { return one.component == older.component; });
  }
  put_before(heir.fallbacks, before.fallbacks);
}

/// Does the change bring code of another class or another build?
bool brings_code(const Content& change) {
  return std::any_of(change.members.begin(), change.members.end(), [](const auto& member) {
    return member.type || is_other_code(*member.base->shell, *member.next->shell) ||
           is_other_code(*member.base->core, *member.next->core) ||
           is_other_code(*member.base->fsm, *member.next->fsm);
  });
}

/// The core that a rollback of the change brings back: that from before the changes that it joins.
const CoreBase& core_before(const System& system, const Content& change,
                            const PreparedMember& member) {
  for (const auto& one : system.probations) {
    if (one->reported() || !concerns(system, change, one->content())) continue;
    if (!can_join(change, one->content())) continue;
    for (std::size_t i = 0; i < one->members().size(); ++i) {
      if (one->content().members[i].component != member.component) continue;
      return *one->members()[i].origin.bundle->core;
    }
  }
  return *member.base->core;
}

/// The states that a rollback of the change cannot bring back.
void note_one_ways(const System& system, const Content& change, std::vector<std::string>& notes) {
  for (const PreparedMember& one : change.members) {
    const CoreBase& before = core_before(system, change, one);
    note_one_way(one.component->name(), *one.next->core, before, one.state, notes);
  }
  for (const PreparedResource& one : change.resources) {
    if (one.parts.core == nullptr) continue;
    note_one_way(one.resource->name(), *one.parts.core, *one.base.core, one.state, notes);
  }
  if (!change.barrier) return;
  for (const auto& one : change.barrier->replacements) {
    note_replaced(*one.from, *one.into, one.state, notes);
  }
}

std::string in_words(const std::vector<std::string>& names) {
  std::string words;
  for (std::size_t i = 0; i < names.size(); ++i) {
    words += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return words;
}

}  // namespace

bool concerns(const System& system, const Content& change, const Content& before) {
  MAUVE_ON_THREAD(control);
  if (same_names(system, change, names_of(before))) return true;
  // Rules refer to everything. But what a rule brings to components of its own waits for nobody,
  // and takes nothing from a change on probation that brought rules.
  const bool by_rule = change.probation && change.probation->only_undo;
  if (change.changes_rules || (before.changes_rules && !by_rule)) return true;
  // The order of resources within each other is that of all.
  if (has_resources(change) && has_resources(before)) return true;
  Resources joined;
  for (const auto& resource : before.new_resources) joined.insert(resource.get());
  Resources reached(change.leaving_resources.begin(), change.leaving_resources.end());
  if (change.barrier) {  // all that reach its resources wait meanwhile
    reached = resources_touched(system.architecture, change);
  }
  if (any_leads_into(change, joined) || any_leads_into(before, reached)) return true;
  return clash(system.architecture, change, before);
}

bool changes_modes_only(const Content& change) {
  if (change.probation || change.changes_rules || change.barrier || change.in_place ||
      has_resources(change) || !change.fallbacks.empty()) {
    return false;
  }
  return std::all_of(change.members.begin(), change.members.end(), [](const auto& member) {
    return member.part == Part::changes && member.next == member.base;
  });
}

bool can_join(const Content& change, const Content& before) {
  const bool plain = !change.barrier && !change.changes_rules && !change.in_place &&
                     !has_resources(change) && (change.probation || !brings_code(change));
  if (!plain || !before.resources.empty()) return false;
  // A failure of the change must not lead back to before what a rule brought.
  if (before.probation->only_undo && change.probation && !change.probation->only_undo) return false;
  return std::all_of(change.members.begin(), change.members.end(), [](const auto& member) {
    return member.part == Part::changes || member.part == Part::follows;
  });
}

void Heritage::add(ProbationPeriod& before) {
  for (std::size_t i = 0; i < before.members().size(); ++i) {
    members_.push_back({before.content().members[i].component, before.members()[i].origin});
  }
  rollbacks_.push_back(before.rollback().get());
  held_.push_back(before.hold());
  generations_.insert(generations_.end(), before.generations().begin(), before.generations().end());
  std::sort(generations_.begin(), generations_.end());
}

const Origin* Heritage::origin_of(const ComponentBase& component) const {
  const auto found = std::find_if(members_.begin(), members_.end(), [&](const Member& member) {
    return member.component == &component;
  });
  return found == members_.end() ? nullptr : &found->origin;
}

bool Heritage::has(const Rollback& before) const {
  return std::find(rollbacks_.begin(), rollbacks_.end(), &before) != rollbacks_.end();
}

Origin further_back(const Origin& before, const Origin& now, const PreparedMember& change) {
  Origin origin = before;
  if (before.state != StatePolicy::drop) {
    const auto gives = [&](const Bundle& from) {
      const auto plan = plan_hand_over(*from.core, *before.bundle->core, StatePolicy::keep);
      return plan && plan->from != nullptr;
    };
    if (now.state != StatePolicy::drop && gives(*change.next)) {
      origin.state_kept = nullptr;
    } else if (gives(*now.bundle)) {
      origin.state_kept = now.bundle;
    }
  }
  if (before.mode == Mode::keep) {
    origin.mode = now.mode;
  } else if (now.mode != Mode::keep) {
    origin.mode = Mode::keep;  // there and back
  }
  if (before.state == StatePolicy::keep || now.state == StatePolicy::drop) origin.state = now.state;
  return origin;
}

void adopt(Content& before, Content& heir, const std::vector<MemberRollback>& members,
           Retired& retired) {
  for (PreparedMember& older : before.members) {
    const auto at = std::find_if(heir.members.begin(), heir.members.end(),
                                 [&](const auto& one) { return one.component == older.component; });
    const auto index = static_cast<std::size_t>(at - heir.members.begin());
    PreparedMember& newer = *at;
    if (!members[index].in_force) newer.next = older.next;
    const Bundle* const kept = members[index].origin.state_kept.get();
    retire_between(*older.next, {older.base.get(), newer.next.get(), kept}, retired);
    newer.base = older.base;
    newer.part = older.part;
    newer.owner = std::move(older.owner);
    if (older.type) newer.type = std::move(older.type);
  }
  heir.changes_rules = heir.changes_rules || before.changes_rules;
  adopt_fallbacks(before, heir);
  put_before(heir.new_resources, before.new_resources);
  put_before(heir.leaving_resources, before.leaving_resources);
  put_before(heir.left_resources, before.left_resources);
}

void retire_kept(std::vector<MemberRollback>& members, const Content& change, Retired& retired) {
  for (std::size_t i = 0; i < members.size(); ++i) {
    const auto kept = std::exchange(members[i].origin.state_kept, nullptr);
    const PreparedMember& member = change.members[i];
    if (kept != nullptr) retire_between(*kept, {member.base.get(), member.next.get()}, retired);
  }
}

void retire_kept(std::vector<MemberRollback>& members, const Content& change, const Content& heir,
                 const std::vector<MemberRollback>& heirs, Retired& retired) {
  for (std::size_t i = 0; i < members.size(); ++i) {
    const auto kept = std::exchange(members[i].origin.state_kept, nullptr);
    if (kept == nullptr) continue;
    const PreparedMember& older = change.members[i];
    const auto at = std::find_if(heir.members.begin(), heir.members.end(),
                                 [&](const auto& one) { return one.component == older.component; });
    const auto index = static_cast<std::size_t>(at - heir.members.begin());
    const Bundle* const still = heirs[index].origin.state_kept.get();
    if (kept.get() == still) continue;
    retire_between(*kept, {older.next.get(), at->base.get(), at->next.get(), still}, retired);
  }
}

std::vector<std::string> notes_of(const System& system, const Content& change) {
  MAUVE_ON_THREAD(control);
  std::vector<std::string> notes;
  for (const PreparedMember& one : change.members) {
    if (stays_stopped(system, change, one)) {
      notes.push_back(one.component->name() +
                      " stays stopped: a user stopped it, and only a start of it by a user ends "
                      "that");
    }
    note_unexamined(one.component->name(), *one.base->core, *one.next->core, one.state, notes);
    note_fresh(one.component->name(), *one.base->core, *one.next->core, one.state, notes);
  }
  for (const PreparedResource& one : change.resources) {
    if (one.parts.core == nullptr) continue;
    note_unexamined(one.resource->name(), *one.base.core, *one.parts.core, one.state, notes);
    note_fresh(one.resource->name(), *one.base.core, *one.parts.core, one.state, notes);
  }
  if (changes_modes_only(change)) return notes;
  if (change.probation) note_one_ways(system, change, notes);
  for (const auto& one : system.probations) {
    if (one->reported() || !concerns(system, change, one->content())) continue;
    const OpenProbation open = one->look();
    const std::string names =
        open.components.empty() ? "" : " (" + in_words(open.components) + ")";  // rules have none
    const std::string first = std::to_string(open.generations.front());
    const bool only_undo = change.probation ? change.probation->only_undo : open.rules.only_undo;
    if (can_join(change, one->content())) {
      const bool several = open.generations.size() > 1;
      notes.push_back(generations_in_words(open.generations) + names +
                      (several ? " are still on probation, and this change joins them: "
                               : " is still on probation, and this change joins it: ") +
                      (only_undo ? "`undo`, but no failure," : "`undo` or a failure") +
                      " takes back " + (several ? "all of them together" : "both together") +
                      ", back to before generation " + first +
                      "; only a `mauvectl confirm` before this change keeps " +
                      (several ? "the older ones" : "the older one"));
    } else {
      notes.push_back("the probation of " + generations_in_words(open.generations) + names +
                      (only_undo ? " ends early: only `undo` rolls back, to before this change"
                                 : " ends early: a failure rolls back to before this change only"));
    }
  }
  return notes;
}

}  // namespace mauve::exec
