// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/check_rules.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "arch/build/check_steps.h"
#include "arch/build/lost_names.h"
#include "arch/build/unguarded_devices.h"
#include "arch/parse/built_in.h"
#include "arch/parse/quantity.h"
#include "arch/parse/target.h"
#include "arch/text/read.h"
#include "mauve/host/architecture.h"
#include "model/element/elements.h"
#include "model/element/hand_over.h"
#include "plugin/load/catalog.h"

namespace mauve::arch {
namespace {

using rules::Comparison;

/// A condition is looked at a hundred times a second, on a thread that runs no user code.
Status check_stored(const Quantity& quantity) {
  const ServiceBase* service = quantity.target.service;
  if (const PortBase* port = quantity.target.port) {
    const Binding* binding = connection(quantity.target.element, *port);
    if (binding != nullptr) service = &binding->service();
  }
  if (service == nullptr || service->resource().type().name == kSharedData) return ok();
  return refuse({Errc::unsupported, "value_not_stored"}, service->address(),
                service->address() + " is not stored but made for each reader",
                "write a condition on an observable, or on shared_data");
}

class Checker {
 public:
  Checker(const Spec& spec, const Architecture& architecture, const plugin::Catalog& catalog,
          Problems& problems)
      : spec_(spec), architecture_(architecture), catalog_(catalog), problems_(problems) {}

  rules::Supervision run() {
    for (const TransactionSpec& one : spec_.transactions) {
      supervision_.transactions.emplace_back(one.name, steps(one, "transactions." + one.name));
    }
    for (const RuleSpec& rule : spec_.rules) check(rule);
    for (const ComponentSpec& component : spec_.components) check(component);
    return std::move(supervision_);
  }

 private:
  rules::Steps steps(const TransactionSpec& transaction, const std::string& at) {
    check_steps(transaction, at, {spec_, architecture_, catalog_}, problems_);
    rules::Steps steps;
    for (const StepSpec& step : transaction.steps) steps.push_back(step.step);
    return steps;
  }

  void check(const RuleSpec& spec) {
    const std::string at = "rules." + spec.name.value;
    if (spec.when) check(*spec.when, at + ".when");
    if (spec.until) check(*spec.until, at + ".until");
    if (!spec.transaction.value.empty()) check_name(spec.transaction, at + ".do");
    rules::Steps inline_steps = steps(spec.steps, at + ".do");
    if (!spec.when) return;  // reported by the parser
    rules::Rule rule{spec.name.value, spec.when->value,       {},
                     spec.timing,     spec.transaction.value, std::move(inline_steps)};
    if (spec.until) rule.until = spec.until->value;
    rule.when_unknown = spec.when_unknown;
    rule.max_age = spec.max_age;
    supervision_.rules.push_back(std::move(rule));
  }

  void check(const ComponentSpec& component) {
    for (const PlacedText& name : component.may_request) {
      auto& known = supervision_.may_request[component.name];
      const std::string at = component.name + ".may_request";
      if (std::find(known.begin(), known.end(), name.value) != known.end()) {
        problems_.add(name.where, {Errc::duplicate, "file_says_twice"}, at,
                      "\"" + name.value + "\" appears twice");
      }
      check_name(name, at);
      known.push_back(name.value);
    }
  }

  void check_name(const PlacedText& name, const std::string& at) {
    std::vector<std::string> names;
    for (const TransactionSpec& one : spec_.transactions) names.push_back(one.name);
    if (std::find(names.begin(), names.end(), name.value) != names.end()) return;
    problems_.add(name.where, {Errc::unknown_name, "unknown_transaction"}, at,
                  "there is no transaction \"" + name.value + "\"",
                  nearest_hint(name.value, names));
  }

  void check(const ConditionSpec& condition, const std::string& at) {
    for (const Comparison& comparison : condition.value.comparisons()) {
      const std::string& address = comparison.address;
      if (was_refused(spec_, architecture_, address.substr(0, address.find('.')))) continue;
      const Status good = check_comparison(architecture_, comparison);
      if (good || is_lost(spec_, address)) continue;
      problems_.add(condition.where, reason_of(good.error()), at,
                    address + " (at character " + std::to_string(comparison.place) +
                        "): " + good.error().message,
                    good.error().hint);
    }
  }

  const Spec& spec_;
  const Architecture& architecture_;
  const plugin::Catalog& catalog_;
  Problems& problems_;
  rules::Supervision supervision_;
};

}  // namespace

Status check_comparison(const Architecture& architecture, const Comparison& comparison) {
  const auto quantity = find_quantity(architecture, comparison.address);
  if (!quantity) return quantity.error();
  if (Status kind = rules::check_kind(comparison, quantity->kind); !kind) return kind;
  if (Status stored = check_stored(*quantity); !stored) return stored;
  const auto* word = std::get_if<std::string>(&comparison.operand);
  const auto& words = quantity->words;
  const bool possible = word == nullptr || words.empty() ||
                        std::find(words.begin(), words.end(), *word) != words.end();
  if (possible) return ok();
  return refuse({Errc::invalid_value, "condition_never_true"}, comparison.address,
                "is never \"" + *word + "\"", nearest_hint(*word, words));
}

rules::Supervision check_rules(const Spec& spec, const Architecture& architecture,
                               const plugin::Catalog& catalog, Problems& problems) {
  return Checker(spec, architecture, catalog, problems).run();
}

namespace {

/// The core that the step puts in place, against the core that the architecture has there.
Status check_state(const rules::Step& step, const Architecture& architecture,
                   const plugin::Catalog& catalog) {
  const auto component = find_component(architecture, step.subject);
  const auto type = catalog.core(step.object);
  if (!component || !type) return ok();  // gone since the file was read
  const Bundle& present = *(*component)->bundle();
  if (present.core_type.name == step.object) return ok();
  std::shared_ptr<CoreBase> core;
  const std::string address = step.subject + ".core";
  if (Status made = make_element(address, type->make, core); !made) return made;
  const auto policy = step.fresh ? StatePolicy::drop : StatePolicy::offer;
  const Status good = check_hand_over(*present.core, *core, policy);
  const Status gone = drop_elements(address, [&core] { core.reset(); });
  return good ? gone : good;
}

Status check_wiring(const rules::Steps& steps, const Architecture& architecture) {
  Wiring after(architecture);
  for (const rules::Step& step : steps) {
    const bool connects = step.action == rules::Action::connect;
    if (!connects && step.action != rules::Action::disconnect) continue;
    const auto target = find_target(architecture, step.subject);
    const auto service = architecture.find_service(step.object);
    if (!target || target->port == nullptr || (connects && !service)) continue;
    after.connect(target->element.name() + ".ports." + std::string(target->port->name()),
                  connects ? *service : nullptr);
  }
  return after.check();
}

void add_notes(const std::string& at, const rules::Steps& steps, const Architecture& architecture,
               const plugin::Catalog& catalog, std::vector<Wiring::Note>& notes) {
  const std::string refused = "is refused when it fires ";
  if (const Status good = check_wiring(steps, architecture); !good) {
    notes.push_back({at, refused + "on the connections of this file: " + good.error().at + " " +
                             good.error().message});
  }
  for (const rules::Step& step : steps) {
    if (step.action != rules::Action::swap) continue;
    const Status good = check_state(step, architecture, catalog);
    if (good) continue;
    const bool state = good.error().code == Errc::type_mismatch;
    notes.push_back({at, refused + "while " + step.subject +
                             " has the core of this file: " + good.error().message +
                             (state ? "; \"state\": \"drop\" in the step permits it" : "")});
  }
}

}  // namespace

std::vector<Wiring::Note> notes_on(const rules::Supervision& supervision,
                                   const Architecture& architecture,
                                   const plugin::Catalog& catalog) {
  std::vector<Wiring::Note> notes = unguarded_devices(architecture);
  std::ranges::move(lost_names(supervision, architecture, catalog), std::back_inserter(notes));
  for (const auto& [name, steps] : supervision.transactions) {
    add_notes("transactions." + name, steps, architecture, catalog, notes);
  }
  for (const rules::Rule& rule : supervision.rules) {
    add_notes("rules." + rule.name + ".do", rule.steps, architecture, catalog, notes);
  }
  return notes;
}

std::vector<Wiring::Note> notes_on_file(const rules::Supervision& supervision,
                                        const Architecture& architecture,
                                        const plugin::Catalog& catalog) {
  auto notes = Wiring(architecture).notes();
  std::ranges::move(notes_on(supervision, architecture, catalog), std::back_inserter(notes));
  return notes;
}

}  // namespace mauve::arch
