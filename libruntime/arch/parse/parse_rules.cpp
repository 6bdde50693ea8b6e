// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/parse_rules.h"

#include <algorithm>
#include <string>
#include <utility>

#include "arch/parse/parse_element.h"
#include "base/address.h"

namespace mauve::arch {
namespace {

using rules::Action;

constexpr Action kActions[] = {Action::disconnect, Action::connect, Action::swap,
                               Action::set,        Action::stop,    Action::start};

/// The form of the address that a step changes.
struct Shape {
  std::size_t names;
  std::string_view what;
  std::string_view example;
};

Shape shape_of(Action action) {
  switch (action) {
    case Action::disconnect:
    case Action::connect:
      return {3, "port", "\"gnss.ports.fix\""};
    case Action::set:
      return {3, "property", "\"control.core.gain\""};
    case Action::swap:
    case Action::stop:
    case Action::start:
      break;
  }
  return {1, "component", "\"control\""};
}

void read_subject(const Source& source, Action action, std::string& into) {
  const auto text = read_text(source);
  if (!text) return;
  const Shape shape = shape_of(action);
  const auto address = Address::parse(*text);
  const bool is_port = address && address->part(1) == "ports";
  if (!address || address->size() != shape.names || is_port != (shape.what == "port")) {
    return source.refuse("\"" + text->substr(0, kLongestName) + "\" is not the address of a " +
                             std::string(shape.what),
                         "write one such as " + std::string(shape.example));
  }
  into = *text;
}

bool is_service(std::string_view text) {
  const auto address = Address::parse(text);
  return address && address->size() == 2;
}

/// "to" and "core".
Field object_field(std::string_view key, bool (*valid)(std::string_view), std::string_view hint,
                   StepSpec& spec) {
  return {key, [&spec, valid, hint](const Source& value) {
            if (auto text = read_name(value, valid, hint)) spec.step.object = text->value;
            spec.object_where = value.node.where;
          }};
}

void read_max_age(const Source& source, Duration& into) {
  const auto limit = read_duration(source);
  if (limit == Duration{0}) source.refuse("must be over 0");
  into = limit.value_or(Duration{0});
}

void require(const Source& source, bool there, std::string_view key, std::string_view example) {
  if (there) return;
  source.refuse("\"" + std::string(key) + "\" is missing", "write " + std::string(example),
                {Errc::invalid_value, "file_key_missing"});
}

bool has_key(const Source& source, std::string_view key) {
  const auto* members = source.node.get_if<Node::Object>();
  return members != nullptr && std::any_of(members->begin(), members->end(),
                                           [&](const Member& m) { return m.key == key; });
}

void read_step(const Source& source, StepSpec& spec) {
  const Action action = spec.step.action;
  const Field subject{rules::to_string(action),
                      [&](const Source& value) { read_subject(value, action, spec.step.subject); }};
  if (action == Action::connect) {
    read_object(source, {subject,
                         object_field("to", is_service, "a service such as \"fix.write\"", spec),
                         {"max_age",
                          [&](const Source& value) { read_max_age(value, spec.step.max_age); }}});
    require(source, has_key(source, "to"), "to", "\"to\": \"resource.service\"");
  } else if (action == Action::swap) {
    read_object(source, {subject,
                         object_field("core", is_type_name, "\"plugin/name\" of a core", spec),
                         {"state", [&](const Source& value) {
                            spec.step.fresh = read_word(value, {"drop"}).has_value();
                          }}});
    require(source, has_key(source, "core"), "core", "\"core\": \"plugin/name\"");
  } else if (action == Action::set) {
    read_object(source, {subject, {"value", [&](const Source& value) {
                                     spec.step.value = to_value(value.node);
                                     spec.object_where = value.node.where;
                                     if (spec.step.value.is_null()) value.refuse("has no value");
                                   }}});
    require(source, has_key(source, "value"), "value", "\"value\": 0.3");
  } else {
    read_object(source, {subject});
  }
}

/// Finds the one action of a step. False when there is none, or more than one; that is reported.
bool find_action(const Source& source, Action& action) {
  std::vector<std::string> words;
  std::vector<Action> found;
  for (const Action one : kActions) {
    words.emplace_back(rules::to_string(one));
    if (has_key(source, words.back())) found.push_back(one);
  }
  if (found.size() == 1) {
    action = found[0];
    return true;
  }
  const auto* members = source.node.get_if<Node::Object>();
  if (members == nullptr) {
    source.refuse_kind("an object", "write { \"stop\": \"control\" }");
  } else if (found.size() > 1) {
    source.refuse("a step does one thing", "write two steps");
  } else {
    const std::string first = members->empty() ? std::string() : members->front().key;
    source.refuse("says nothing to do", nearest_hint(first, words));
  }
  return false;
}

void read_steps(const Source& source, TransactionSpec& transaction) {
  read_items(source, [&](const Source& item) {
    StepSpec spec;
    spec.where = spec.object_where = item.node.where;
    if (!find_action(item, spec.step.action)) return;
    read_step(item, spec);
    if (!spec.step.subject.empty()) transaction.steps.push_back(std::move(spec));
  });
  const auto* items = source.node.get_if<Node::Array>();
  if (items != nullptr && items->empty()) source.refuse("has no step");
}

void read_condition(const Source& source, std::optional<ConditionSpec>& into) {
  const auto text = read_text(source);
  if (!text) return;
  auto condition = rules::Condition::parse(*text);
  if (!condition) {
    const Error& error = condition.error();
    return source.refuse(error.message, error.hint, reason_of(error));
  }
  into = ConditionSpec{*std::move(condition), source.node.where};
}

void read_do(const Source& source, RuleSpec& rule) {
  if (source.node.get_if<std::string>() != nullptr) {
    if (auto name = read_name(source, is_name, "the name of a transaction")) {
      rule.transaction = *std::move(name);
    }
  } else if (source.node.get_if<Node::Array>() != nullptr) {
    rule.steps.where = source.node.where;
    read_steps(source, rule.steps);
  } else {
    source.refuse_kind("the name of a transaction, or an array of steps");
  }
}

void read_when_unknown(const Source& source, rules::Unknown& into) {
  using rules::Unknown;
  constexpr Unknown kAnswers[] = {Unknown::hold, Unknown::fire};
  const auto word =
      read_word(source, {std::string(to_string(kAnswers[0])), std::string(to_string(kAnswers[1]))});
  if (word) into = kAnswers[*word];
}

void read_rule(const Source& source, RuleSpec& rule) {
  const auto* members = read_object(
      source,
      {{"name",
        [&](const Source& value) {
          if (auto name = read_name(value, is_name, "a name such as \"gnss_lost\"")) {
            rule.name = *std::move(name);
          }
        }},
       {"when", [&](const Source& value) { read_condition(value, rule.when); }},
       {"for", [&](const Source& value) { rule.timing.hold = read_duration(value).value_or(0ns); }},
       {"until", [&](const Source& value) { read_condition(value, rule.until); }},
       {"when_unknown", [&](const Source& value) { read_when_unknown(value, rule.when_unknown); }},
       {"max_age", [&](const Source& value) { read_max_age(value, rule.max_age); }},
       {"do", [&](const Source& value) { read_do(value, rule); }},
       {"cool_down",
        [&](const Source& value) { rule.timing.cool_down = read_duration(value).value_or(1s); }},
       {"per_hour", [&](const Source& value) {
          const auto count = read_integer(value, 1, kMostPerHour);
          if (count) rule.timing.per_hour = static_cast<unsigned>(*count);
        }}});
  if (members == nullptr) return;
  require(source, has_key(source, "name"), "name", "\"name\": \"gnss_lost\"");
  require(source, has_key(source, "when"), "when", "\"when\": \"gnss.core.satellites < 4\"");
  require(source, has_key(source, "do"), "do", "\"do\": \"name of a transaction\"");
}

}  // namespace

void read_transactions(const Source& source, std::vector<TransactionSpec>& into) {
  read_members(source, [&](const Member& member, const Source& value) {
    if (!good_key(member, value)) return;
    TransactionSpec transaction;
    transaction.name = member.key;
    transaction.where = member.where;
    read_steps(value, transaction);
    into.push_back(std::move(transaction));
  });
}

void read_change(const Source& source, TransactionSpec& into) {
  into.where = source.node.where;
  read_steps(source, into);
}

void read_rules(const Source& source, std::vector<RuleSpec>& into) {
  read_items(source, [&](const Source& item) {
    RuleSpec rule;
    const auto* members = item.node.get_if<Node::Object>();
    std::string at = source.at + "[" + std::to_string(into.size()) + "]";
    if (members != nullptr) {
      for (const Member& member : *members) {
        const auto* text = member.value.get_if<std::string>();
        if (member.key == "name" && text != nullptr && is_name(*text)) at = "rules." + *text;
      }
    }
    read_rule({item.node, std::move(at), item.problems}, rule);
    const auto same = std::find_if(into.begin(), into.end(), [&](const RuleSpec& other) {
      return !rule.name.value.empty() && other.name.value == rule.name.value;
    });
    if (same != into.end()) {
      item.problems.add(rule.name.where, {Errc::duplicate, "file_says_twice"},
                        "rules." + rule.name.value, "a rule has this name already",
                        "it is in line " + std::to_string(same->name.where.line));
    }
    into.push_back(std::move(rule));
  });
}

void read_may_request(const Source& source, std::vector<PlacedText>& into) {
  read_items(source, [&](const Source& item) {
    if (auto name = read_name(item, is_name, "the name of a transaction")) {
      into.push_back(*std::move(name));
    }
  });
}

}  // namespace mauve::arch
