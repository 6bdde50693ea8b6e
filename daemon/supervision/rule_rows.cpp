// SPDX-License-Identifier: LGPL-3.0-or-later
#include "supervision/rule_rows.h"

#include <algorithm>

#include "arch/text/value_json.h"
#include "base/duration.h"

namespace mauve::daemon {

std::string shown(const rules::SightChange& change) {
  if (!change.value.is_null()) {
    return to_string(change.value);
  }
  return change.max_age == Duration{0}
             ? "not there"
             : "not there, or older than " + format_duration(change.max_age);
}

std::string consequence(const rules::Engine& engine, const rules::SightChange& change) {
  std::string holding;
  std::string firing;
  for (const auto& rule : engine.rules()) {
    if (std::ranges::find(change.rules, rule.name) == change.rules.end()) {
      continue;
    }
    auto& names = rule.when_unknown == rules::Unknown::fire ? firing : holding;
    names += (names.empty() ? "" : ", ") + rule.name;
  }
  std::string text;
  if (!holding.empty()) {
    text = "rule " + holding + " cannot be judged and does not fire (when_unknown is hold)";
  }
  if (!firing.empty()) {
    text += (text.empty() ? "rule " : "; rule ") + firing + " fires (when_unknown is fire)";
  }
  return text;
}

Json lost_values(const rules::Engine& engine) {
  Json rows = Json::array();
  for (const auto& one : engine.lost()) {
    rows.push_back({{"address", one.address},
                    {"value", arch::to_json(one.value)},
                    {"rules", one.rules},
                    {"text", shown(one) + ": " + consequence(engine, one)}});
  }
  return rows;
}

Json blocked_rules(const rules::Engine& engine, Instant now, const rules::ReadFresh& read) {
  Json rows = Json::array();
  for (const auto rule : engine.blocked()) {
    const auto report = engine.report(rule, now, read);
    rows.push_back({{"rule", engine.rules()[rule].name},
                    {"state", to_string(report.state)},
                    {"answer", report.answer},
                    {"why_not", report.why_not}});
  }
  return rows;
}

Json rule_row(const rules::Engine& engine, std::size_t index, Instant now, Instant t0,
              const rules::ReadFresh& read) {
  const auto& rule = engine.rules()[index];
  const auto report = engine.report(index, now, read);
  Json values = Json::array();
  for (const auto& [address, value] : report.values) {
    values.push_back({{"address", address}, {"value", arch::to_json(value)}});
  }
  return {{"name", rule.name},
          {"state", to_string(report.state)},
          {"when", rule.when.text()},
          {"values", std::move(values)},
          {"for", format_duration(rule.timing.hold)},
          {"until", rule.until ? Json(rule.until->text()) : Json()},
          {"when_unknown", to_string(rule.when_unknown)},
          {"max_age", rule.max_age == Duration{0} ? Json() : Json(format_duration(rule.max_age))},
          {"do", rule.transaction.empty() ? Json() : Json(rule.transaction)},
          {"cool_down", format_duration(rule.timing.cool_down)},
          {"per_hour", rule.timing.per_hour},
          {"fired", report.times},
          {"fired_ns", report.last ? Json(*report.last - t0) : Json()},
          {"ago_ns", report.last ? Json(now - *report.last) : Json()},
          {"answer", report.answer},
          {"why_not", report.why_not}};
}

}  // namespace mauve::daemon
