// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/prepared.h"

#include <typeinfo>
#include <utility>

#include <mauve/host/architecture.h>
#include <mauve/host/component.h>

namespace mauve::exec {

/// Builds are loaded apart, so each has a type_info of its own; their names are equal.
bool is_other_code(const Configurable& before, const Configurable& after) {
  return &typeid(before) != &typeid(after);
}

PreparedMember member_of(ComponentBase& component, Mode mode) {
  PreparedMember member;
  member.component = &component;
  member.base = component.bundle();
  member.next = component.bundle();
  member.mode = mode;
  return member;
}

PreparedChange make_prepared(const Architecture& architecture,
                             std::unique_ptr<PreparedChange::Content> content) {
  for (const PreparedMember& member : content->members) {
    if (member.part == Part::joins) continue;
    content->alive.push_back(architecture.owner_of(*member.component));
  }
  for (const PreparedResource& one : content->resources) {
    content->alive.push_back(architecture.owner_of(*one.resource));
  }
  for (const ResourceBase* leaving : content->leaving_resources) {
    content->alive.push_back(architecture.owner_of(*leaving));
  }
  Retired elements;
  for (auto& owner : architecture.owners()) elements.keep(std::move(owner));
  return PreparedChange(std::move(content), std::move(elements));
}

}  // namespace mauve::exec
