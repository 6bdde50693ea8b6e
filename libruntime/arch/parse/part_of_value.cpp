// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/part_of_value.h"

#include "arch/parse/quantity.h"
#include "base/terminal_text.h"
#include "mauve/host/architecture.h"

namespace mauve::arch {
namespace {

/// "arm.core.offset" of "arm.core.offset.x"; empty when no value has this part.
std::string_view whole_of(const Architecture& architecture, std::string_view address) {
  std::string_view whole = address;
  while (whole.find('.') != std::string_view::npos) {
    whole = whole.substr(0, whole.rfind('.'));
    if (find_target(architecture, whole)) return whole;
  }
  return {};
}

/// A structure or an array is a part of a value too, although it cannot be compared.
bool is_composed(const Error& error) { return error.id == "value_not_comparable"; }

/// "x.y" and "3" to {"x":{"y":3}}
std::string nested(std::string_view fields, std::string_view value) {
  const auto dot = fields.find('.');
  const bool last = dot == std::string_view::npos;
  return "{\"" + std::string(fields.substr(0, dot)) +
         "\":" + (last ? std::string(value) : nested(fields.substr(dot + 1), value)) + "}";
}

}  // namespace

Error part_not_read(const Architecture& architecture, std::string_view address, Error otherwise) {
  const auto whole = whole_of(architecture, address);
  const auto part = find_quantity(architecture, address);
  if (whole.empty() || part) return otherwise;
  if (!is_composed(part.error())) {
    return part.error().id == "unknown_field" ? part.error() : otherwise;
  }
  return refuse({Errc::unsupported, "part_without_address"}, std::string(address),
                "a structure or an array within a value has no address of its own",
                "mauvectl get " + std::string(whole));
}

Error part_not_set(const Architecture& architecture, std::string_view address,
                   std::string_view value, Error otherwise) {
  const auto whole = whole_of(architecture, address);
  const auto part = find_quantity(architecture, address);
  if (whole.empty()) return otherwise;
  if (!part && !is_composed(part.error())) {
    return part.error().id == "unknown_field" ? part.error() : otherwise;
  }
  const auto target = find_target(architecture, whole);
  std::string hint = "mauvectl show " + target->element.name() + " lists the properties";
  if (target->property != nullptr) {
    hint = "mauvectl set " + std::string(whole) + "='" +
           nested(address.substr(whole.size() + 1), beginning_of(value)) +
           "'; it keeps the other fields";
  } else if (target->service != nullptr && target->element.resource->find_service("write")) {
    hint = "mauvectl write " + target->element.name() + ".write '{...}' takes a whole value";
  }
  return refuse({Errc::unsupported, "field_not_alone"}, std::string(address),
                "a field is not set alone", std::move(hint));
}

}  // namespace mauve::arch
