// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/number_list.h"

#include <cstddef>

namespace mauve {

std::string numbers_in_words(std::span<const std::uint64_t> numbers) {
  std::string text;
  for (std::size_t first = 0, next = 0; first < numbers.size(); first = next) {
    next = first + 1;
    while (next < numbers.size() && numbers[next] == numbers[next - 1] + 1) ++next;
    if (first > 0) text += next == numbers.size() ? " and " : ", ";
    text += std::to_string(numbers[first]);
    if (next - first > 1) text += " to " + std::to_string(numbers[next - 1]);
  }
  return text;
}

std::string generations_in_words(std::span<const std::uint64_t> generations) {
  return (generations.size() == 1 ? "generation " : "generations ") + numbers_in_words(generations);
}

}  // namespace mauve
