// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/diff_rules.h"

#include <algorithm>
#include <string>
#include <utility>

#include "arch/compare/describe_rules.h"

namespace mauve::arch {
namespace {

Value rules_by_name(const rules::Supervision& supervision) {
  Value::Object all;
  Value::Array described = describe_rules(supervision);
  for (std::size_t i = 0; i < described.size(); ++i) {
    all.emplace_back(supervision.rules[i].name, std::move(described[i]));
  }
  return all;
}

Value::Array names_of(const std::vector<rules::Rule>& rules) {
  Value::Array names;
  for (const rules::Rule& rule : rules) names.emplace_back(rule.name);
  return names;
}

Value permissions(const rules::Supervision& supervision) {
  Value::Object all;
  for (const auto& [component, transactions] : supervision.may_request) {
    Value::Array names;
    for (const std::string& name : transactions) names.emplace_back(name);
    all.emplace_back(component, std::move(names));
  }
  return all;
}

/// Adds a line for each entry that differs; the order in the file has no meaning.
void compare_named(const char* kind, const Value& present, const Value& wanted,
                   std::vector<Line>& lines) {
  const auto address = [kind](const std::string& name) { return std::string(kind) + "." + name; };
  for (const auto& [name, then] : *wanted.get_if<Value::Object>()) {
    const Value* const now = present.find(name);
    if (now != nullptr && same_value(*now, then)) continue;
    lines.push_back(make_line(kind, address(name), now == nullptr ? Value() : *now, then));
  }
  for (const auto& [name, now] : *present.get_if<Value::Object>()) {
    if (wanted.find(name) == nullptr) lines.push_back(make_line(kind, address(name), now, {}));
  }
}

}  // namespace

std::vector<Line> compare(const rules::Supervision& present, const rules::Supervision& wanted) {
  std::vector<Line> lines;
  compare_named("transactions", describe_transactions(present), describe_transactions(wanted),
                lines);
  compare_named("rules", rules_by_name(present), rules_by_name(wanted), lines);
  compare_named("may_request", permissions(present), permissions(wanted), lines);
  const Value::Array before = names_of(present.rules);
  const Value::Array after = names_of(wanted.rules);
  if (std::ranges::is_permutation(before, after) && before != after) {
    lines.push_back(make_line("rules", "rules", before, after));
  }
  return lines;
}

std::vector<std::string> changed_rules(const rules::Supervision& present,
                                       const rules::Supervision& wanted) {
  std::vector<Line> lines;
  compare_named("transactions", describe_transactions(present), describe_transactions(wanted),
                lines);
  compare_named("rules", rules_by_name(present), rules_by_name(wanted), lines);
  const auto differs = [&lines](const std::string& address) {
    return std::ranges::find(lines, address, &Line::address) != lines.end();
  };
  std::vector<std::string> names;
  for (const rules::Rule& rule : wanted.rules) {
    if (differs("rules." + rule.name) || differs("transactions." + rule.transaction)) {
      names.push_back(rule.name);
    }
  }
  return names;
}

}  // namespace mauve::arch
