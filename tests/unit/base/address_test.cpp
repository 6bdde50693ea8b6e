// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/address.h"

#include <string>

#include <gtest/gtest.h>

namespace mauve {
namespace {

TEST(Name, IsLowerCaseLettersDigitsAndUnderscores) {
  EXPECT_TRUE(is_name("a"));
  EXPECT_TRUE(is_name("laser_2"));
  EXPECT_TRUE(is_name(std::string(64, 'a')));
}

TEST(Name, RefusesEverythingElse) {
  for (const std::string text :
       {"", "2a", "_a", "A", "aB", "a-b", "a.b", "a b", "a\n", "\xc3\xa9"}) {
    EXPECT_FALSE(is_name(text)) << text;
  }
  EXPECT_FALSE(is_name(std::string(65, 'a')));
  EXPECT_FALSE(is_name(std::string_view("a\0b", 3)));
}

TEST(Name, SaysWhatANameLooksLike) {
  const Status status = check_name("Laser", "components.Laser");

  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().at, "components.Laser");
  EXPECT_EQ(status.error().message, "\"Laser\" is not a name");
  EXPECT_NE(status.error().hint.find("lower-case"), std::string::npos);
}

TEST(TypeName, IsANameOrPluginSlashName) {
  EXPECT_TRUE(is_type_name("shared_data"));
  EXPECT_TRUE(is_type_name("drivers/laser_sim"));
  for (const std::string text : {"", "/", "drivers/", "/laser", "a/b/c", "../x", "a/1"}) {
    EXPECT_FALSE(is_type_name(text)) << text;
  }
}

TEST(RevisedName, EndsWithARevision) {
  EXPECT_TRUE(is_revised_name("laser_scan/1"));
  EXPECT_TRUE(is_revised_name("guidance/core/12"));
  for (const std::string text : {"", "laser_scan", "laser_scan/", "laser_scan/0", "laser_scan/01",
                                 "laser_scan/1a", "/1", "a/b/c/1", "a/1234567890"}) {
    EXPECT_FALSE(is_revised_name(text)) << text;
  }
}

TEST(Address, SplitsAtTheDots) {
  const auto address = Address::parse("control.core.gain");

  ASSERT_TRUE(address);
  EXPECT_EQ(address->size(), 3U);
  EXPECT_EQ(address->element(), "control");
  EXPECT_EQ(address->part(1), "core");
  EXPECT_EQ(address->part(2), "gain");
  EXPECT_EQ(address->part(3), "");
  EXPECT_EQ(address->rest(), "core.gain");
  EXPECT_EQ(address->text(), "control.core.gain");
}

TEST(Address, MayBeOneName) {
  const auto address = Address::parse("control");

  ASSERT_TRUE(address);
  EXPECT_EQ(address->size(), 1U);
  EXPECT_EQ(address->element(), "control");
  EXPECT_EQ(address->rest(), "");
}

TEST(Address, RefusesEmptyPartsAndStrangeCharacters) {
  for (const std::string text : {"", ".", "a.", ".a", "a..b", "a.B", "a/b", "a b"}) {
    const auto address = Address::parse(text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().at, text);
  }
}

TEST(Address, RefusesMoreThan255Characters) {
  std::string text = "a";
  while (text.size() < 255) text += ".a";

  EXPECT_TRUE(Address::parse(text));
  const auto address = Address::parse(text + ".a");
  ASSERT_FALSE(address);
  EXPECT_EQ(address.error().code, Errc::limit);
}

}  // namespace
}  // namespace mauve
