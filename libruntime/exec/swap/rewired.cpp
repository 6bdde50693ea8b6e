// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap/rewired.h"

#include <mauve/architecture.h>

namespace mauve::exec {
namespace {

using Content = PreparedChange::Content;

void put(Wiring& wiring, const ResourceBase& resource, const Bindings& bindings) {
  wiring.put(resource.name(), resource.shell(), bindings);
}

void put(Wiring& wiring, const ComponentBase& component, const Bundle& bundle) {
  wiring.put(component.name(), *bundle.shell, *bundle.bindings);
}

void go_forth(Wiring& wiring, const Content& change) {
  for (const ResourceBase* leaving : change.leaving_resources) wiring.remove(leaving->name());
  for (const PreparedMember& one : change.members) {
    if (one.part == Part::leaves) wiring.remove(one.component->name());
  }
  for (const auto& joining : change.new_resources) put(wiring, *joining, joining->bindings());
  for (const PreparedResource& one : change.resources) {
    if (one.parts.bindings != nullptr) put(wiring, *one.resource, *one.parts.bindings);
  }
  for (const PreparedMember& one : change.members) {
    if (one.part != Part::leaves && one.next != nullptr) put(wiring, *one.component, *one.next);
  }
}

void go_back(Wiring& wiring, const Content& change) {
  for (const auto& joined : change.new_resources) wiring.remove(joined->name());
  for (const PreparedMember& one : change.members) {
    if (one.part == Part::joins) wiring.remove(one.component->name());
  }
  for (const ResourceBase* left : change.leaving_resources) put(wiring, *left, left->bindings());
  for (const PreparedResource& one : change.resources) {
    if (one.base.bindings != nullptr) put(wiring, *one.resource, *one.base.bindings);
  }
  for (const PreparedMember& one : change.members) {
    if (one.part != Part::joins && one.base != nullptr) put(wiring, *one.component, *one.base);
  }
}

}  // namespace

Wiring rewired(const Architecture& architecture, const Content& change) {
  Wiring wiring(architecture);
  go_forth(wiring, change);
  return wiring;
}

bool clash(const Architecture& architecture, const Content& change, const Content& before) {
  Wiring wiring(architecture);
  go_back(wiring, before);
  go_forth(wiring, change);
  return !wiring.check();
}

}  // namespace mauve::exec
