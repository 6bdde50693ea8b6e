// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/quantity.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/address.h"
#include "base/name.h"
#include "mauve/detail/data_status.h"
#include "mauve/host/architecture.h"
#include "mauve/host/deployer.h"

namespace mauve::arch {
namespace {

using rules::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 11> kStatistics{{
    {"state", Kind::word},
    {"core", Kind::word},
    {"fsm_state", Kind::word},
    {"releases", Kind::number},
    {"missed", Kind::number},
    {"overruns", Kind::number},
    {"over_budget", Kind::number},
    {"implausible", Kind::number},
    {"late", Kind::duration},
    {"lateness_max", Kind::duration},
    {"elapsed_max", Kind::duration},
}};

/// The kind that the description of a type names; none for structures and sequences.
std::optional<Kind> kind_of_type(const Value& described) {
  const auto* name = described.get_if<std::string>();
  if (name == nullptr) return std::nullopt;
  if (*name == "bool") return Kind::truth;
  if (*name == "duration") return Kind::duration;
  return *name == "string" || name->starts_with("text[") ? Kind::word : Kind::number;
}

std::vector<std::string> field_names(const Value& described) {
  std::vector<std::string> names;
  if (const auto* fields = described.get_if<Value::Array>()) {
    for (const Value& field : *fields) names.push_back(*field.find("name")->get_if<std::string>());
  }
  return names;
}

const Value* find_field(const Value& described, std::string_view name) {
  const auto* fields = described.get_if<Value::Array>();
  if (fields == nullptr) return nullptr;
  for (const Value& field : *fields) {
    if (*field.find("name") == Value(name)) return field.find("kind");
  }
  return nullptr;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

class Finder {
 public:
  Finder(const Architecture& architecture, Address address)
      : architecture_(architecture), address_(std::move(address)) {}

  Result<Quantity> run() {
    const auto element = find_element(architecture_, address_.element());
    if (!element) return element.error();
    quantity_.target.element = *element;
    if (element->component != nullptr && address_.size() == 2) return statistic();
    const auto target = find_target(architecture_, first_parts());
    if (!target) return target.error();
    quantity_.target = *target;
    for (std::size_t i = used_; i < address_.size(); ++i) {
      quantity_.fields.emplace_back(address_.part(i));
    }
    if (target->property != nullptr) return of_type(target->property->type());
    if (target->observable != nullptr) {
      return is_age() ? aspect(Quantity::Aspect::age) : of_type(target->observable->type());
    }
    const Signature& signature =
        target->port != nullptr ? target->port->signature() : target->service->signature();
    if (signature.kind != PortKind::read) {
      return refused({Errc::type_mismatch, "no_value_to_read"},
                     "is a " + std::string(to_string(signature.kind)) +
                         (target->port != nullptr ? " port" : " service") +
                         ", it has no value to read");
    }
    return of_readable(*signature.data);
  }

 private:
  Result<Quantity> statistic() {
    const auto* const found =
        std::find_if(kStatistics.begin(), kStatistics.end(),
                     [&](const auto& one) { return one.first == address_.part(1); });
    if (found == kStatistics.end()) {
      std::vector<std::string> names;
      for (const auto& [name, kind] : kStatistics) names.emplace_back(name);
      auto hint = did_you_mean(address_.part(1), names);
      if (hint.empty()) hint = "a component has: " + listed(names);
      return refused({Errc::unknown_name, "unknown_address"}, "there is nothing of this name",
                     std::move(hint));
    }
    quantity_.statistic = found->first;
    quantity_.kind = found->second;
    if (found->first == "state") {
      for (const auto state :
           {ComponentState::not_configured, ComponentState::stopped, ComponentState::running,
            ComponentState::faulted, ComponentState::recovering}) {
        quantity_.words.emplace_back(to_string(state));
      }
    } else if (found->first == "fsm_state") {
      for (const auto* state : quantity_.target.element.component->fsm().states()) {
        quantity_.words.emplace_back(state->name());
      }
    }
    return quantity_;
  }

  /// The part of the address that names the whole value: "fix.read", or three names.
  std::string first_parts() {
    const Element& element = quantity_.target.element;
    const bool service =
        element.resource != nullptr && element.resource->find_service(address_.part(1)) != nullptr;
    used_ = std::min(address_.size(), service ? std::size_t{2} : std::size_t{3});
    std::string text(address_.element());
    for (std::size_t i = 1; i < used_; ++i) text.append(".").append(address_.part(i));
    return text;
  }

  Result<Quantity> of_readable(const DataType& type) {
    if (is_age()) return aspect(Quantity::Aspect::age);
    if (quantity_.fields == std::vector<std::string>{"status"}) {
      for (const auto status : {DataStatus::no_data, DataStatus::old_data, DataStatus::new_data,
                                DataStatus::stale, DataStatus::timed_out}) {
        quantity_.words.emplace_back(to_string(status));
      }
      return aspect(Quantity::Aspect::status);
    }
    return of_type(type);
  }

  [[nodiscard]] bool is_age() const { return quantity_.fields == std::vector<std::string>{"age"}; }

  /// The last part of the address is no field.
  Quantity aspect(Quantity::Aspect which) {
    quantity_.aspect = which;
    quantity_.kind = which == Quantity::Aspect::age ? Kind::duration : Kind::word;
    quantity_.fields.clear();
    return quantity_;
  }

  Result<Quantity> of_type(const DataType& type) {
    if (type.describe == nullptr) {
      return refused({Errc::unsupported, "type_not_described"}, "its type has no description",
                     "describe it: a static type_name and fields(), see mauve/type.h");
    }
    Value described = type.describe();
    for (const auto& field : quantity_.fields) {
      const Value* inner = find_field(described, field);
      if (inner == nullptr) return no_field(field, described);
      described = Value(*inner);
    }
    const auto kind = kind_of_type(described);
    if (!kind) {
      const auto names = field_names(described);
      return refused({Errc::type_mismatch, "value_not_comparable"},
                     "is no plain value that can be compared",
                     names.empty() ? "" : "name a field of it: " + listed(names));
    }
    quantity_.kind = *kind;
    return quantity_;
  }

  Error no_field(const std::string& field, const Value& described) {
    const auto names = field_names(described);
    auto hint = did_you_mean(field, names);
    if (hint.empty() && !names.empty()) hint = "it has: " + listed(names);
    return refused({Errc::unknown_name, "unknown_field"}, "the value has no field " + field,
                   std::move(hint));
  }

  Error refused(Reason reason, std::string message, std::string hint = {}) {
    return refuse(reason, address_.text(), std::move(message), std::move(hint));
  }

  const Architecture& architecture_;
  Address address_;
  Quantity quantity_;
  std::size_t used_ = 0;
};

}  // namespace

Result<Quantity> find_quantity(const Architecture& architecture, std::string_view address) {
  auto parsed = Address::parse(address);
  if (!parsed) return parsed.error();
  return Finder(architecture, *std::move(parsed)).run();
}

Value field_of(const Value& value, const std::vector<std::string>& fields) {
  const Value* found = &value;
  for (const auto& field : fields) {
    found = found->find(field);
    if (found == nullptr) return {};
  }
  return *found;
}

}  // namespace mauve::arch
