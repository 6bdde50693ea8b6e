// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/prepare/edit_properties.h"

#include <algorithm>

#include "base/name.h"
#include "model/element/hand_over.h"
#include "model/element/missing_fields.h"

#include <mauve/property.h>

namespace mauve::exec {
namespace {

std::string unit_in_words(const PropertyBase& property) {
  return property.unit().empty() ? "has no unit" : "is in " + std::string(property.unit());
}

/// "core.gain" -> {"core", "gain"}.
std::pair<std::string_view, std::string_view> split(std::string_view path) {
  const auto dot = path.find('.');
  return dot == std::string_view::npos ? std::pair{std::string_view{}, path}
                                       : std::pair{path.substr(0, dot), path.substr(dot + 1)};
}

Error no_property(const Configurable& element, std::string_view name) {
  std::vector<std::string> names;
  for (const PropertyBase* known : element.properties()) names.emplace_back(known->name());
  const std::string nearest = nearest_name(name, names);
  return refuse({Errc::unknown_name, "unknown_property"},
                element.address() + "." + std::string(name), "there is no property of this name",
                nearest.empty() ? "" : "did you mean " + element.address() + "." + nearest + "?");
}

/// The address exists, perhaps, in the core that runs: the sentence names the new one.
Error no_property_of_new_core(const std::string& core, const Configurable& element,
                              std::string_view name) {
  std::vector<std::string> names;
  for (const PropertyBase* known : element.properties()) names.emplace_back(known->name());
  const std::string known = known_names(name, names);
  return refuse({Errc::unknown_name, "unknown_property"},
                element.address() + "." + std::string(name),
                "core " + core + " has no property " + std::string(name),
                known.empty() ? "leave it out: the core has no properties" : known);
}

/// May the value of a property of one core go on in another core?
Status can_stay(const PropertyBase& old, const PropertyBase& same, const Edit& edit) {
  const std::string defaults = "--defaults begins with the values of the new core";
  const std::string hint = "--set " + std::string(same.name()) + "=... gives it one, " + defaults;
  if (same.type().to_value == nullptr) {
    return refuse({Errc::unsupported, "type_not_described"}, same.address(),
                  "is " + same.type().name +
                      ", a type without a description, so its value cannot "
                      "stay",
                  defaults);
  }
  if (!same_type(same.type(), old.type())) {
    return refuse({Errc::type_mismatch, "value_cannot_stay"}, same.address(),
                  "is " + same.type().name + " in the new core and " + old.type().name +
                      " in the one in force, so its value cannot stay",
                  hint);
  }
  if (same.unit() != old.unit()) {
    return refuse({Errc::type_mismatch, "value_cannot_stay"}, same.address(),
                  unit_in_words(same) + " in the new core and " + unit_in_words(old) +
                      " in the one in force, so its value cannot stay",
                  hint);
  }
  Status fits = same.accepts(old.value());
  if (fits && edit.allows && same.within() != old.within()) fits = edit.allows(same, old.value());
  if (fits) return fits;
  return refuse(reason_of(fits.error()), same.address(),
                "has a value now that the new core does not take: " + fits.error().message, hint);
}

}  // namespace

bool touches(const Edit& edit, std::string_view element) {
  return std::any_of(edit.properties.begin(), edit.properties.end(),
                     [&](const auto& property) { return split(property.first).first == element; });
}

Status copy_properties(const Configurable& from, Configurable& into) {
  for (const PropertyBase* old : from.properties()) {
    PropertyBase* same = into.find_property(old->name());
    if (same == nullptr || !same_type(same->type(), old->type())) continue;
    if (same->type().to_value == nullptr) {
      return refuse({Errc::unsupported, "type_not_described"}, old->address(),
                    "its type has no description",
                    "describe it: a static type_name and fields(), see mauve/type.h");
    }
    if (Status done = same->set(old->value()); !done) return done;
  }
  return ok();
}

Status keep_values(const Configurable& from, const Edit& edit, Configurable& into) {
  if (edit.values == Values::defaults) return ok();
  for (const PropertyBase* old : from.properties()) {
    PropertyBase* same = into.find_property(old->name());
    const auto set_here = [&](const auto& property) {
      return split(property.first) ==
             std::pair<std::string_view, std::string_view>("core", old->name());
    };
    if (same == nullptr) continue;
    // A new value may leave out fields of a structure: these stay, where the old value can.
    const bool set = std::any_of(edit.properties.begin(), edit.properties.end(), set_here);
    const Status stays = can_stay(*old, *same, edit);
    if (!stays && !set && edit.values == Values::keep) return stays;
    if (Status done = stays ? same->set(old->value()) : ok(); !done) return done;
  }
  return ok();
}

Status set_properties(const Edit& edit, std::string_view name, Configurable& element) {
  for (const auto& [path, value] : edit.properties) {
    const auto [owner, property] = split(path);
    if (owner != name) continue;
    PropertyBase* found = element.find_property(property);
    if (found == nullptr && edit.core && name == "core") {
      return no_property_of_new_core(edit.core->name, element, property);
    }
    if (found == nullptr) return no_property(element, property);
    if (Status allowed = edit.allows ? edit.allows(*found, value) : ok(); !allowed) return allowed;
    if (Status done = found->set(value); !done) return done;
    const Status whole = items_name_all_fields(found->address(), found->type(), value);
    if (!whole) return whole;
  }
  return ok();
}

Status check_paths(const Edit& edit, const std::vector<std::string_view>& elements) {
  for (const auto& [path, value] : edit.properties) {
    const auto owner = split(path).first;
    if (std::find(elements.begin(), elements.end(), owner) != elements.end()) continue;
    std::string list;
    for (const auto element : elements) list += (list.empty() ? "" : ", ") + std::string(element);
    return refuse({Errc::unknown_name, "unknown_property"}, edit.member + "." + path,
                  "is no property", "properties that can change while it runs belong to: " + list);
  }
  return ok();
}

Status check_state_survives(const CoreBase& core, const Edit& edit) {
  const bool same_core = !edit.core.has_value();
  if (!same_core || edit.state == StatePolicy::drop) return ok();
  if (declares_state(core)) return ok();
  return refuse({Errc::unsupported, "state_not_declared"}, core.address(),
                "declares neither a state to hand over nor that it has none, so this change would "
                "silently reset it",
                "say --state drop to start it fresh, or declare mauve::State or mauve::Stateless "
                "in the core");
}

}  // namespace mauve::exec
