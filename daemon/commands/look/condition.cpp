// SPDX-License-Identifier: LGPL-3.0-or-later
/// condition.get: the truth of a condition, as of a rule, now.
#include "rules/condition.h"
#include "arch/build/check_rules.h"
#include "arch/parse/quantity.h"
#include "arch/text/value_json.h"
#include "commands/answer.h"
#include "commands/look/value.h"

namespace mauve::daemon {

Result<Json> condition(Running& running, const Call& call) {
  const auto wanted = rules::Condition::parse(text_or(call.params, "condition"));
  if (!wanted) {
    return refuse(reason_of(wanted.error()), "condition", wanted.error().message,
                  wanted.error().hint);
  }
  const rules::Read reader = [&](const std::string& address) -> Result<Value> {
    const auto quantity = arch::find_quantity(running.architecture, address);
    return quantity ? read(running, *quantity) : Result<Value>(quantity.error());
  };
  auto values = Json::array();
  for (const auto& comparison : wanted->comparisons()) {
    if (auto possible = arch::check_comparison(running.architecture, comparison); !possible) {
      return possible.error();
    }
    const auto value = reader(comparison.address);
    if (!value) {
      return value.error();
    }
    values.push_back({{"address", comparison.address}, {"value", arch::to_json(*value)}});
  }
  std::string error;
  const auto truth = wanted->evaluate(reader, error);
  return Json{{"condition", wanted->text()},
              {"holds", truth == rules::Truth::unknown ? Json() : Json(truth == rules::Truth::yes)},
              {"values", std::move(values)},
              {"generation", running.generation.load()}};
}

}  // namespace mauve::daemon
