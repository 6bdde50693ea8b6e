// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

Paint paint_of_rule(const std::string& state) {
  if (state == "fired" || state == "holding" || state == "held") return Paint::yellow;
  return state == "disabled" || state == "limited" ? Paint::red : Paint::plain;
}

/// "gnss.core.satellites < 4 (now 9)": the values in the order of the addresses.
std::string condition_of(const Json& rule) {
  std::string values;
  for (const Json& one : rule.value("values", Json::array())) {
    join(values, word(one, "value"));
  }
  return word(rule, "when") + (values.empty() ? "" : " (now " + values + ")");
}

std::string last_of(const Json& rule) {
  if (whole_number(rule, "fired") == 0) return "never";
  return nanoseconds_in_words(number(rule, "ago_ns")) + " ago";
}

/// Without a width no column is limited, and an answer can be a whole refusal.
constexpr std::size_t kMostOfText = 60;

}  // namespace

std::string render_rules(const Json& result, Look look) {
  const Json items = result.is_object() ? result.value("items", Json::array()) : Json::array();
  if (items.empty()) return "none\n";
  Table table({{"NAME"},
               {"STATE"},
               {"CONDITION"},
               {"FIRED", true, 2},
               {"LAST", false, 1},
               {"ANSWER"},
               {"WHY NOT"}});
  bool is_cut = false;
  const auto shown = [&](const std::string& text) {
    if (look.width > 0 || columns(text) <= kMostOfText) return text;
    is_cut = true;
    return cut(text, kMostOfText);
  };
  for (const Json& rule : items) {
    std::string state = word(rule, "state");
    std::string why_not = word(rule, "why_not");
    const std::string answer = word(rule, "answer");
    const bool bad = answer.starts_with("refused") || answer.starts_with("unsafe");
    Paint paint = paint_of_rule(state);
    if (const auto held = word(rule, "held"); !held.empty() && state != "held") {
      state += ", held";
      if (paint == Paint::plain) paint = Paint::yellow;
      why_not = why_not.empty() ? held : held + "; " + why_not;
    }
    table.add({{word(rule, "name")},
               {state, paint},
               {condition_of(rule)},
               {word(rule, "fired")},
               {last_of(rule)},
               {shown(answer), bad ? Paint::red : Paint::plain},
               {shown(why_not)}});
  }
  return table.text(look.width, look.colour) +
         (is_cut ? "mauvectl rules NAME prints the texts that are cut\n" : "");
}

std::string render_rule(const Json& result, Look look) {
  const Json items = result.is_object() ? result.value("items", Json::array()) : Json::array();
  if (items.empty()) return "none\n";
  Json rule = items.front();
  rule["last"] = last_of(rule);
  if (member(rule, "do").is_null()) rule["do"] = "its own steps";
  for (const char* key : {"ago_ns", "fired_ns"}) rule.erase(key);
  return render_object(rule, look);
}

}  // namespace mauve::ctl
