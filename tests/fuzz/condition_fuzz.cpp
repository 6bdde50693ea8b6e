// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes: Condition::parse() answers with a condition that can be evaluated, within its limits,
// or with a sentence that says where it went wrong.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "rules/condition.h"

namespace {

namespace rules = mauve::rules;

void require(bool condition) {
  if (!condition) std::abort();
}

/// Something of every kind, chosen by the address.
mauve::Result<mauve::Value> value_of(const std::string& address) {
  switch (address.size() % 6) {
    case 0:
      return mauve::Value(static_cast<std::int64_t>(address.back()));
    case 1:
      return mauve::Value(0.5 * static_cast<double>(address.back()));
    case 2:
      return mauve::Value(address.substr(address.rfind('.') + 1));
    case 3:
      return mauve::Value(address.back() % 2 == 0);
    case 4:
      return mauve::Value("20ms");
    default:
      return mauve::refuse(mauve::Errc::unknown_name, address, "there is nothing of this name");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto condition = rules::Condition::parse(text);
  if (!condition) {
    require(!condition.error().message.empty());
    require(condition.error().message.size() < 300);
    return 0;
  }
  require(condition->text() == text && text.size() <= rules::Condition::kLongest);
  require(!condition->comparisons().empty());
  require(condition->comparisons().size() <= rules::Condition::kComparisons);
  for (const auto& one : condition->comparisons()) {
    require(text.substr(one.place - 1).starts_with(one.address));
  }
  // A negation of the whole is the opposite, where it is not too long or too deep.
  std::string error;
  const auto truth = condition->evaluate(value_of, error);
  if (const auto negated = rules::Condition::parse("not (" + std::string(text) + ")")) {
    require(negated->evaluate(value_of, error) == !truth);
  }
  require(!rules::in_words(condition->values(value_of)).empty());
  return 0;
}
