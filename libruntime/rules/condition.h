// SPDX-License-Identifier: LGPL-3.0-or-later
/// Condition: the expression that a rule watches, such as
/// `pose.core.sigma >= 2.5 and not gnss.core.fixed`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "mauve/host/value.h"
#include "mauve/result.h"
#include "mauve/time.h"

namespace mauve::rules {

/// The truth of a condition now. Unknown: an address has no value now.
enum class Truth : std::uint8_t { no, yes, unknown };
[[nodiscard]] Truth operator!(Truth truth);

enum class Compare : std::uint8_t { less, less_equal, greater, greater_equal, equal, not_equal };
[[nodiscard]] std::string_view to_string(Compare compare);

/// The kind of operand that the value behind an address can be compared with.
enum class Kind : std::uint8_t { truth, number, duration, word };
/// "true or false", "a number", "a duration", "a word".
[[nodiscard]] std::string_view to_string(Kind kind);

/// An integer is a std::uint64_t if it is above 2^63 - 1, and a std::int64_t otherwise. Two
/// integers are compared exactly, an integer and a decimal number as doubles.
using Operand = std::variant<bool, std::int64_t, std::uint64_t, double, Duration, std::string>;
[[nodiscard]] Kind kind_of(const Operand& operand);

/// `control.missed > 3`; an address alone means `== true`.
struct Comparison {
  std::string address;
  Compare compare = Compare::equal;
  Operand operand = true;
  std::size_t place = 1;  ///< of the address in the text, counted in characters from 1
};

/// The value behind an address now; null: there is none now. An error: there is no such address.
using Read = std::function<Result<Value>(const std::string& address)>;
/// The same; null also when the value is older than `max_age`. Zero: of any age.
using ReadFresh = std::function<Result<Value>(const std::string& address, Duration max_age)>;

/// Addresses with their values, each once.
using Values = std::vector<std::pair<std::string, Value>>;
/// "gnss.core.satellites is 9, control.state is running".
[[nodiscard]] std::string in_words(const Values& values);

/// A condition that was read. Immutable; evaluating it takes time and memory: never [rt].
class Condition {
 public:
  static constexpr std::size_t kLongest = 1000;    ///< characters
  static constexpr std::size_t kDeepest = 32;      ///< parentheses and `not` within each other
  static constexpr std::size_t kComparisons = 64;  ///< in one condition

  /// Refused: a text that is no condition. The message names the character; `at` is empty. [any]
  [[nodiscard]] static Result<Condition> parse(std::string_view text);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<Comparison>& comparisons() const { return comparisons_; }

  /// Reads every address. The first error of `read` is put into `error`, and makes the comparison
  /// unknown. A value of another kind than the operand is unknown as well.
  [[nodiscard]] Truth evaluate(const Read& read, std::string& error) const;

  /// The value behind each address now; null where there is none.
  [[nodiscard]] Values values(const Read& read) const;

 private:
  friend class Parser;
  Condition() = default;

  /// In the order of evaluation, on a stack: a comparison pushes its truth, the others replace
  /// their operands by the result.
  enum class Step : std::uint8_t { compare, negate, both, either };

  std::string text_;
  std::vector<Comparison> comparisons_;
  std::vector<Step> steps_;
};

/// Refused: a value of this kind cannot be compared like this, such as a word with `<`.
[[nodiscard]] Status check_kind(const Comparison& comparison, Kind kind);

}  // namespace mauve::rules
