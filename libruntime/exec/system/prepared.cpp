// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/prepared.h"

#include <typeinfo>

#include <mauve/component.h>

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

}  // namespace mauve::exec
