// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/describe_rules.h"

#include <string>
#include <utility>

#include "base/duration.h"

namespace mauve::arch {
namespace {

using rules::Action;

Value describe(const rules::Step& step) {
  Value::Object object{{std::string(to_string(step.action)), step.subject}};
  if (step.action == Action::connect) object.emplace_back("to", step.object);
  if (step.action == Action::swap) object.emplace_back("core", step.object);
  if (step.action == Action::set) object.emplace_back("value", step.value);
  if (step.max_age > Duration{0}) object.emplace_back("max_age", format_duration(step.max_age));
  if (step.fresh) object.emplace_back("state", "drop");
  return object;
}

Value::Array describe(const rules::Steps& steps) {
  Value::Array array;
  for (const rules::Step& step : steps) array.push_back(describe(step));
  return array;
}

Value describe(const rules::Rule& rule) {
  const rules::Timing defaults;
  const rules::Timing& timing = rule.timing;
  Value::Object object{{"name", rule.name}, {"when", rule.when.text()}};
  const auto add_duration = [&](const char* key, Duration value, Duration otherwise) {
    if (value != otherwise) object.emplace_back(key, format_duration(value));
  };
  add_duration("for", timing.hold, defaults.hold);
  if (rule.until) object.emplace_back("until", rule.until->text());
  if (rule.when_unknown != rules::Unknown::hold) {
    object.emplace_back("when_unknown", to_string(rule.when_unknown));
  }
  add_duration("max_age", rule.max_age, Duration{0});
  object.emplace_back(
      "do", rule.transaction.empty() ? Value(describe(rule.steps)) : Value(rule.transaction));
  add_duration("cool_down", timing.cool_down, defaults.cool_down);
  if (timing.per_hour != defaults.per_hour) {
    object.emplace_back("per_hour", static_cast<std::int64_t>(timing.per_hour));
  }
  return object;
}

}  // namespace

Value::Object describe_transactions(const rules::Supervision& supervision) {
  Value::Object object;
  for (const auto& [name, steps] : supervision.transactions) {
    object.emplace_back(name, describe(steps));
  }
  return object;
}

Value::Array describe_rules(const rules::Supervision& supervision) {
  Value::Array array;
  for (const rules::Rule& rule : supervision.rules) array.push_back(describe(rule));
  return array;
}

}  // namespace mauve::arch
