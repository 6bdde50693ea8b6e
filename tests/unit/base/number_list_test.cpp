// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/number_list.h"

#include <vector>

#include <gtest/gtest.h>

namespace mauve {
namespace {

std::string in_words(const std::vector<std::uint64_t>& numbers) {
  return numbers_in_words(numbers);
}

TEST(NumberList, NamesARangeOnlyWhereNoNumberIsMissing) {
  EXPECT_EQ(in_words({}), "");
  EXPECT_EQ(in_words({2}), "2");
  EXPECT_EQ(in_words({2, 3}), "2 to 3");
  EXPECT_EQ(in_words({34, 36}), "34 and 36");
  EXPECT_EQ(in_words({22, 23, 24, 26}), "22 to 24 and 26");
  EXPECT_EQ(in_words({2, 3, 4, 6, 9, 10}), "2 to 4, 6 and 9 to 10");
}

TEST(NumberList, CountsGenerations) {
  EXPECT_EQ(generations_in_words(std::vector<std::uint64_t>{7}), "generation 7");
  EXPECT_EQ(generations_in_words(std::vector<std::uint64_t>{34, 36}), "generations 34 and 36");
}

}  // namespace
}  // namespace mauve
