// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/check_steps.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "arch/parse/target.h"
#include "base/name.h"
#include "mauve/host/architecture.h"
#include "model/element/elements.h"
#include "model/element/missing_fields.h"
#include "model/port/connection.h"
#include "model/resource/resource_graph.h"
#include "plugin/load/catalog.h"

namespace mauve::arch {
namespace {

using rules::Action;
using rules::Step;

Result<Target> port_of(const Architecture& architecture, const Step& step) {
  auto target = find_target(architecture, step.subject);
  if (target && target->port == nullptr) {
    return refuse({Errc::type_mismatch, "step_not_possible"}, step.subject, "is no port");
  }
  return target;
}

Status check_connect(const Architecture& architecture, const Step& step) {
  const auto target = port_of(architecture, step);
  if (!target) return target.error();
  const auto service = architecture.find_service(step.object);
  if (!service) return service.error();
  if (Status fits = check_connection(*target->port, nullptr, **service, step.max_age); !fits) {
    return fits;
  }
  const auto* resource = target->element.resource;
  if (resource == nullptr) return ok();
  ResourceGraph graph(architecture);
  graph.connect(*resource, (*service)->resource());
  return graph.check();
}

/// The core that a swap puts in place, when it fits.
Result<CoreType> core_of(const Built& built, const Step& step) {
  const auto component = find_component(built.architecture, step.subject);
  if (!component) return component.error();
  auto core = built.catalog.core(step.object);
  if (!core) return core;
  const Bundle& bundle = *(*component)->bundle();
  Status fits =
      check_contract(step.subject + ".core", *core, bundle.fsm_type, (*component)->type().shell);
  if (!fits) return fits.error();
  return core;
}

Error no_property(const Step& step, const Configurable& core, std::string_view name) {
  std::vector<std::string> names;
  for (const PropertyBase* known : core.properties()) names.emplace_back(known->name());
  return refuse({Errc::unknown_name, "unknown_property"}, step.subject,
                "the new core has no property of this name", known_names(name, names));
}

Status accepts(const PropertyBase& property, const Step& step) {
  Status good = property.accepts(step.value);
  return good ? items_name_all_fields(step.subject, property.type(), step.value) : good;
}

/// Of a core that the same transaction puts in place.
Status check_set_on(const CoreType& type, const Step& step) {
  std::shared_ptr<CoreBase> core;
  const std::string address(rules::element_of(step));
  if (Status made = make_element(address + ".core", type.make, core); !made) return made;
  const std::string_view name = std::string_view(step.subject).substr(address.size() + 6);
  const PropertyBase* property = core->find_property(name);
  return property == nullptr ? Status(no_property(step, *core, name)) : accepts(*property, step);
}

Status check_set(const TransactionSpec& transaction, const Built& built, const Step& step) {
  const auto element = rules::element_of(step);
  const bool of_core = std::string_view(step.subject).substr(element.size()).starts_with(".core.");
  for (const StepSpec& other : transaction.steps) {
    if (!of_core || other.step.action != Action::swap || other.step.subject != element) continue;
    const auto core = core_of(built, other.step);
    return core ? check_set_on(*core, step) : ok();  // the swap itself is reported
  }
  const auto target = find_target(built.architecture, step.subject);
  if (!target) return target.error();
  if (target->property == nullptr) {
    return refuse({Errc::type_mismatch, "step_not_possible"}, step.subject,
                  "is no property, it cannot be set");
  }
  if (target->element.resource != nullptr && !of_core) {
    return refuse({Errc::unsupported, "resource_property_fixed"}, step.subject,
                  "of a resource only properties of its core can change while it runs");
  }
  return accepts(*target->property, step);
}

Status check(const TransactionSpec& transaction, const Built& built, const Step& step) {
  const auto unless = [](const auto& result) { return result ? ok() : Status(result.error()); };
  switch (step.action) {
    case Action::disconnect:
      return unless(port_of(built.architecture, step));
    case Action::connect:
      return check_connect(built.architecture, step);
    case Action::swap:
      return unless(core_of(built, step));
    case Action::set:
      return check_set(transaction, built, step);
    case Action::stop:
    case Action::start:
      return unless(find_component(built.architecture, step.subject));
  }
  return ok();
}

/// The same twice, or a stop and a start.
bool contradict(const Step& a, const Step& b) {
  const auto runs = [](const Step& step) {
    return step.action == Action::stop || step.action == Action::start;
  };
  return a.subject == b.subject && (a.action == b.action || (runs(a) && runs(b)));
}

/// Is the error about the service or the core of the step?
bool is_of_object(const Error& error, const Step& step) {
  return error.at != step.subject &&
         (step.action == Action::connect || step.action == Action::swap);
}

}  // namespace

bool is_lost(const Spec& spec, std::string_view name) {
  return std::ranges::find(spec.lost, name, &PlacedText::value) != spec.lost.end();
}

std::string name_lost_by(const Step& step, const rules::Steps& steps,
                         const Architecture& architecture, const plugin::Catalog& catalog) {
  const auto puts_core = [&step](const Step& other) {
    return other.action == Action::swap && other.subject == rules::element_of(step);
  };
  if (step.action == Action::set && std::ranges::any_of(steps, puts_core)) return {};
  const Spec none;
  const Status good = check({}, {none, architecture, catalog}, step);
  if (good) return {};
  return is_of_object(good.error(), step) ? step.object : step.subject;
}

bool was_refused(const Spec& spec, const Architecture& architecture, std::string_view element) {
  const auto named = [&](const ElementSpec& one) { return one.name == element; };
  const bool in_file = std::any_of(spec.components.begin(), spec.components.end(), named) ||
                       std::any_of(spec.resources.begin(), spec.resources.end(), named);
  return in_file && architecture.find_component(element) == nullptr &&
         architecture.find_resource(element) == nullptr;
}

void check_steps(const TransactionSpec& transaction, const std::string& at, const Built& built,
                 Problems& problems) {
  for (auto spec = transaction.steps.begin(); spec != transaction.steps.end(); ++spec) {
    const Step& step = spec->step;
    const auto earlier = std::find_if(transaction.steps.begin(), spec, [&](const StepSpec& other) {
      return contradict(other.step, step);
    });
    if (earlier != spec) {
      problems.add(spec->where, {Errc::duplicate, "changed_twice"}, at,
                   "all steps take effect at one instant, but another one changes " + step.subject +
                       " as well",
                   "it is in line " + std::to_string(earlier->where.line));
      continue;
    }
    const std::string_view resource =
        std::string_view(step.object).substr(0, step.object.find('.'));
    const bool passed_over =
        was_refused(built.spec, built.architecture, rules::element_of(step)) ||
        (step.action == Action::connect && was_refused(built.spec, built.architecture, resource));
    if (passed_over ||
        (step.action != Action::stop && step.action != Action::start &&
         step.action != Action::disconnect && step.object.empty() && step.value.is_null())) {
      continue;  // reported already
    }
    const Status good = check(transaction, built, step);
    if (good) continue;
    const Error& error = good.error();
    const bool of_object = is_of_object(error, step);
    if (is_lost(built.spec, of_object ? step.object : step.subject)) continue;
    problems.add(of_object ? spec->object_where : spec->where, reason_of(error), at,
                 error.at + ": " + error.message, error.hint);
  }
}

}  // namespace mauve::arch
