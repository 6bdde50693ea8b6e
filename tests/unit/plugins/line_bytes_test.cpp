// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/line_bytes.h>

#include <cstdint>

#include <gtest/gtest.h>

namespace mauve::test {
namespace {

using mauve::serial::LineBytes;
using mauve::serial::LineFiller;

TEST(LineFiller, FillsWhatItsComponentOffersUntilAnotherIsWanted) {
  LineBytes bytes;
  LineFiller first;
  LineFiller second;
  EXPECT_TRUE(first.want(bytes)) << "its thread has to look";
  EXPECT_TRUE(first.want(bytes)) << "and has not looked yet";
  EXPECT_EQ(first.bytes(), nullptr);
  first.choose();
  EXPECT_EQ(first.bytes(), &bytes);
  EXPECT_FALSE(first.want(bytes));

  EXPECT_FALSE(second.want(bytes)) << "the first has not let go";
  second.choose();
  EXPECT_EQ(second.bytes(), nullptr);
  first.choose();
  EXPECT_EQ(first.bytes(), nullptr);
  EXPECT_TRUE(second.want(bytes));
  second.choose();
  EXPECT_EQ(second.bytes(), &bytes);
}

TEST(LineFiller, ThatEndsLeavesTheBytesOfItsSuccessor) {
  LineBytes bytes;
  LineFiller first;
  LineFiller second;
  static_cast<void>(first.want(bytes));
  first.choose();
  static_cast<void>(second.want(bytes));
  first.choose();
  static_cast<void>(second.want(bytes));
  first.end();
  second.choose();
  EXPECT_EQ(second.bytes(), &bytes);
  second.end();
  EXPECT_EQ(bytes.filler, 0U);

  static_cast<void>(first.want(bytes));
  first.end();
  EXPECT_EQ(bytes.filler, 0U) << "nor does an offer stay that no thread took";
}

TEST(LineFiller, TakesOneOfTwoOffersAndLeavesTheOtherFree) {
  LineBytes first;
  LineBytes second;
  LineFiller filler;
  static_cast<void>(filler.want(first));
  static_cast<void>(filler.want(second));
  filler.choose();
  EXPECT_EQ(filler.bytes(), &second);
  EXPECT_EQ(first.filler, 0U);

  static_cast<void>(filler.want(first));
  filler.choose();
  EXPECT_EQ(filler.bytes(), &first);
  EXPECT_EQ(second.filler, 0U);
}

TEST(LineFiller, TakesWhatAJobOfferedByHalfBeforeItWasAborted) {
  LineBytes bytes;
  LineFiller filler;
  bytes.home = reinterpret_cast<std::uintptr_t>(&bytes);
  bytes.wanted = bytes.filler = reinterpret_cast<std::uintptr_t>(&filler);
  filler.choose();
  EXPECT_EQ(filler.bytes(), nullptr);
  EXPECT_TRUE(filler.want(bytes));
  filler.choose();
  EXPECT_EQ(filler.bytes(), &bytes);
  filler.end();

  bytes.filler = reinterpret_cast<std::uintptr_t>(&filler);
  filler.empty_handed(bytes);
  EXPECT_EQ(bytes.filler, 0U);
}

}  // namespace
}  // namespace mauve::test
