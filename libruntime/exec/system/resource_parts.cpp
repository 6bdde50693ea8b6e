// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/resource_parts.h"

#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve::exec {

bool goes_on_at_replacement(const Binding& before, const Binding* after) {
  if (after == nullptr) return false;
  const ResourceBase& old = before.service().resource();
  const ResourceBase& now = after->service().resource();
  return &old != &now && old.name() == now.name();
}

}  // namespace mauve::exec
