// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/condition.h"

#include <algorithm>
#include <compare>
#include <optional>

#include "base/duration.h"

namespace mauve::rules {
namespace {

Truth truth_of(bool value) { return value ? Truth::yes : Truth::no; }

Truth both(Truth a, Truth b) {
  if (a == Truth::no || b == Truth::no) return Truth::no;
  return a == Truth::yes && b == Truth::yes ? Truth::yes : Truth::unknown;
}

Truth either(Truth a, Truth b) { return !both(!a, !b); }

Truth compared(std::partial_ordering order, Compare compare) {
  if (order == std::partial_ordering::unordered) return Truth::unknown;  // NaN
  switch (compare) {
    case Compare::less:
      return truth_of(order < 0);
    case Compare::less_equal:
      return truth_of(order <= 0);
    case Compare::greater:
      return truth_of(order > 0);
    case Compare::greater_equal:
      return truth_of(order >= 0);
    case Compare::equal:
      return truth_of(order == 0);
    case Compare::not_equal:
      return truth_of(order != 0);
  }
  return Truth::unknown;
}

/// Compares a value with the operand, of any alternative.
struct Against {
  const Value& value;
  Compare compare;

  Truth operator()(bool operand) const {
    const auto* actual = value.get_if<bool>();
    return actual == nullptr ? Truth::unknown : compared(*actual <=> operand, compare);
  }
  Truth operator()(std::int64_t operand) const {
    const auto* actual = value.get_if<std::int64_t>();
    if (actual != nullptr) return compared(*actual <=> operand, compare);
    const bool is_larger = value.get_if<std::uint64_t>() != nullptr;  // than any std::int64_t
    return is_larger ? compared(std::strong_ordering::greater, compare)
                     : (*this)(static_cast<double>(operand));
  }
  Truth operator()(std::uint64_t operand) const {
    const auto* actual = value.get_if<std::uint64_t>();
    if (actual != nullptr) return compared(*actual <=> operand, compare);
    const bool is_smaller = value.get_if<std::int64_t>() != nullptr;  // than any std::uint64_t here
    return is_smaller ? compared(std::strong_ordering::less, compare)
                      : (*this)(static_cast<double>(operand));
  }
  Truth operator()(double operand) const {
    const auto number = value.number();
    return number ? compared(*number <=> operand, compare) : Truth::unknown;
  }
  Truth operator()(Duration operand) const {
    const auto* text = value.get_if<std::string>();
    if (text == nullptr) return Truth::unknown;
    const auto actual = parse_duration(*text);
    return actual ? compared(*actual <=> operand, compare) : Truth::unknown;
  }
  Truth operator()(const std::string& operand) const {
    const auto* actual = value.get_if<std::string>();
    return actual == nullptr ? Truth::unknown : compared(actual->compare(operand) <=> 0, compare);
  }
};

/// "9", "faulted"; texts bare.
std::string shown(const Value& value) {
  constexpr std::size_t kLongest = 64;
  if (value.is_null()) return "not there";
  const auto* text = value.get_if<std::string>();
  return (text == nullptr ? to_string(value) : *text).substr(0, kLongest);
}

}  // namespace

Truth operator!(Truth truth) {
  if (truth == Truth::unknown) return truth;
  return truth == Truth::no ? Truth::yes : Truth::no;
}

std::string_view to_string(Compare compare) {
  constexpr std::string_view kTexts[] = {"<", "<=", ">", ">=", "==", "!="};
  return kTexts[static_cast<std::size_t>(compare)];
}

std::string_view to_string(Kind kind) {
  constexpr std::string_view kTexts[] = {"true or false", "a number", "a duration", "a word"};
  return kTexts[static_cast<std::size_t>(kind)];
}

Kind kind_of(const Operand& operand) {
  constexpr Kind kKinds[] = {Kind::truth,  Kind::number,   Kind::number,
                             Kind::number, Kind::duration, Kind::word};
  return kKinds[operand.index()];
}

Truth Condition::evaluate(const Read& read, std::string& error) const {
  std::vector<Truth> stack;
  auto comparison = comparisons_.begin();
  const auto pop = [&] {
    const Truth top = stack.back();
    stack.pop_back();
    return top;
  };
  for (const Step step : steps_) {
    if (step == Step::compare) {
      const auto value = read(comparison->address);
      if (!value && error.empty()) error = mauve::to_string(value.error());
      stack.push_back(value ? std::visit(Against{*value, comparison->compare}, comparison->operand)
                            : Truth::unknown);
      ++comparison;
    } else if (step == Step::negate) {
      stack.back() = !stack.back();
    } else {
      const Truth right = pop();
      stack.back() = step == Step::both ? both(stack.back(), right) : either(stack.back(), right);
    }
  }
  return stack.back();
}

Values Condition::values(const Read& read) const {
  Values values;
  for (const Comparison& one : comparisons_) {
    const auto known = [&](const auto& value) { return value.first == one.address; };
    if (std::any_of(values.begin(), values.end(), known)) continue;
    const auto value = read(one.address);
    values.emplace_back(one.address, value ? *value : Value());
  }
  return values;
}

std::string in_words(const Values& values) {
  std::string text;
  for (const auto& [address, value] : values) {
    text += (text.empty() ? "" : ", ") + address + " is " + shown(value);
  }
  return text;
}

Status check_kind(const Comparison& comparison, Kind kind) {
  const Kind wanted = kind_of(comparison.operand);
  if (wanted != kind) {
    return refuse({Errc::type_mismatch, "comparison_not_possible"}, comparison.address,
                  "is " + std::string(to_string(kind)) + ", but is compared with " +
                      std::string(to_string(wanted)),
                  kind == Kind::duration ? "write a number and a unit, such as 20ms" : "");
  }
  const bool ordered = kind == Kind::number || kind == Kind::duration;
  if (!ordered && comparison.compare != Compare::equal &&
      comparison.compare != Compare::not_equal) {
    return refuse({Errc::type_mismatch, "comparison_not_possible"}, comparison.address,
                  "is " + std::string(to_string(kind)) + ", which \"" +
                      std::string(to_string(comparison.compare)) + "\" cannot compare",
                  "use == or !=");
  }
  return ok();
}

}  // namespace mauve::rules
