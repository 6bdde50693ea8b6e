// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <mauve/detail/class_name.h>

namespace guidance {
namespace {
struct Hidden {};
template <typename T>
struct Holder {};
}  // namespace
struct Shell {};
}  // namespace guidance

namespace mauve {
namespace {

TEST(ClassName, IsTheNameInTheSource) {
  EXPECT_EQ(class_name(typeid(guidance::Shell)), "guidance::Shell");
  EXPECT_EQ(class_name(typeid(int)), "int");
}

TEST(ClassName, LeavesOutUnnamedNamespaces) {
  EXPECT_EQ(class_name(typeid(guidance::Hidden)), "guidance::Hidden");
  EXPECT_EQ(class_name(typeid(guidance::Holder<guidance::Hidden>)),
            "guidance::Holder<guidance::Hidden>");
}

TEST(ClassName, LeavesOutHowTheLibraryIsVersioned) {
  const std::string name = class_name(typeid(std::vector<std::string>));

  EXPECT_EQ(name.find("__cxx11"), std::string::npos) << name;
}

}  // namespace
}  // namespace mauve
