// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/lost_names.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "arch/build/check_rules.h"
#include "arch/build/check_steps.h"
#include "base/address.h"
#include "mauve/host/architecture.h"

namespace mauve::arch {
namespace {

using rules::Action;
using rules::Rule;
using rules::Step;
using rules::Steps;
using Notes = std::vector<Wiring::Note>;

/// A property or an observable of a core: "control.core.gain".
struct OfCore {
  std::string component;
  std::string name;
};

std::optional<OfCore> of_core(std::string_view text) {
  const auto address = Address::parse(text);
  if (!address || address->size() < 3 || address->part(1) != "core") return std::nullopt;
  return OfCore{std::string(address->element()), std::string(address->part(2))};
}

bool has(const CoreBase& core, const std::string& name) {
  return core.find_property(name) != nullptr || core.find_observable(name) != nullptr;
}

std::string unknown_condition(const Rule& rule) {
  return rule.when_unknown == rules::Unknown::fire
             ? "its condition is unknown, and the rule fires (\"when_unknown\": \"fire\")"
             : "its condition is unknown, and the rule does nothing until it is there again";
}

/// Calls `look` with each comparison of the rule.
template <typename Look>
void each_comparison(const Rule& rule, Look look) {
  for (const auto& comparison : rule.when.comparisons()) look(comparison);
  if (!rule.until) return;
  for (const auto& comparison : rule.until->comparisons()) look(comparison);
}

/// A set on a core that the same steps put in place has nothing to lose.
bool swaps(const Steps& steps, const std::string& component) {
  return std::ranges::any_of(steps, [&](const Step& step) {
    return step.action == Action::swap && step.subject == component;
  });
}

/// The change of a core takes names away.
class Loss {
 public:
  Loss(const Architecture& architecture, const NextCore& next)
      : architecture_(architecture), next_(next) {}

  Notes of(const rules::Supervision& supervision) {
    for (const auto& [name, steps] : supervision.transactions) look("transactions." + name, steps);
    for (const Rule& rule : supervision.rules) {
      each_comparison(rule, [&](const rules::Comparison& comparison) {
        if (!loses(comparison.address)) return;
        add("rules." + rule.name,
            "names " + comparison.address +
                ", which the new core does not have: " + unknown_condition(rule));
      });
      look("rules." + rule.name, rule.steps);
    }
    return std::move(notes_);
  }

 private:
  bool loses(std::string_view address) const {
    const auto one = of_core(address);
    if (!one) return false;
    const auto* component = architecture_.find_component(one->component);
    const CoreBase* const next = component == nullptr ? nullptr : next_(one->component);
    return next != nullptr && has(component->core(), one->name) && !has(*next, one->name);
  }

  void look(const std::string& at, const Steps& steps) {
    for (const Step& step : steps) {
      if (step.action != Action::set || !loses(step.subject)) continue;
      if (swaps(steps, std::string(rules::element_of(step)))) continue;
      add(at, "sets " + step.subject +
                  ", which the new core does not have: the steps are refused until it is there "
                  "again");
    }
  }

  void add(const std::string& at, std::string text) {
    Wiring::Note note{at, std::move(text)};
    if (std::ranges::find(notes_, note) == notes_.end()) notes_.push_back(std::move(note));
  }

  const Architecture& architecture_;
  const NextCore& next_;
  Notes notes_;
};

void add_steps(const std::string& at, const Steps& steps, const Built& built, Notes& notes) {
  TransactionSpec transaction;
  for (const Step& step : steps) transaction.steps.push_back({step, {}, {}});
  Problems problems;
  check_steps(transaction, at, built, problems);
  for (const auto& problem : problems.sorted()) {
    notes.push_back({at, "is refused when it fires: " + problem.error.message});
  }
}

}  // namespace

Notes names_lost_by(const rules::Supervision& supervision, const Architecture& architecture,
                    const NextCore& next) {
  return Loss(architecture, next).of(supervision);
}

Notes lost_names(const rules::Supervision& supervision, const Architecture& architecture,
                 const plugin::Catalog& catalog) {
  const Spec none;  // the steps concern the system that is there
  const Built built{none, architecture, catalog};
  Notes notes;
  for (const auto& [name, steps] : supervision.transactions) {
    add_steps("transactions." + name, steps, built, notes);
  }
  for (const Rule& rule : supervision.rules) {
    each_comparison(rule, [&](const rules::Comparison& comparison) {
      const Status good = check_comparison(architecture, comparison);
      if (good) return;
      notes.push_back({"rules." + rule.name, "names " + comparison.address + ": " +
                                                 good.error().message + "; " +
                                                 unknown_condition(rule)});
    });
    add_steps("rules." + rule.name + ".do", rule.steps, built, notes);
  }
  return notes;
}

std::vector<std::string> lost_of(const rules::Supervision& supervision,
                                 const Architecture& architecture, const plugin::Catalog& catalog) {
  std::vector<std::string> lost;
  const auto add = [&lost](std::string name) {
    if (!name.empty() && std::ranges::find(lost, name) == lost.end()) {
      lost.push_back(std::move(name));
    }
  };
  const auto add_each = [&](const Steps& steps) {
    for (const Step& step : steps) add(name_lost_by(step, steps, architecture, catalog));
  };
  for (const auto& [name, steps] : supervision.transactions) add_each(steps);
  for (const Rule& rule : supervision.rules) {
    each_comparison(rule, [&](const rules::Comparison& comparison) {
      if (!check_comparison(architecture, comparison)) add(comparison.address);
    });
    add_each(rule.steps);
  }
  return lost;
}

}  // namespace mauve::arch
