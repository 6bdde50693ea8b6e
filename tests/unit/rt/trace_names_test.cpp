// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>

#include <mauve/trace.h>

namespace mauve {
namespace {

TEST(TraceNames, AreTheSameNumberForTheSameText) {
  const std::uint32_t scan = trace_name_id("scan");

  EXPECT_EQ(trace_name_id(std::string("sc") + "an"), scan);
  EXPECT_NE(trace_name_id("scan2"), scan);
  EXPECT_EQ(trace_name(scan), "scan");
}

TEST(TraceNames, NothingIsNumberNought) {
  EXPECT_EQ(trace_name_id(""), 0u);
  EXPECT_EQ(trace_name(0), "");
  EXPECT_EQ(trace_name(0xffffff), "") << "nobody's number";
}

TEST(TraceNames, AreKeptWhenWhoGaveThemIsGone) {
  std::uint32_t number = 0;
  {
    const std::string gone = "a name of a plugin that is unloaded";
    number = trace_name_id(gone);
  }
  EXPECT_EQ(trace_name(number), "a name of a plugin that is unloaded");
}

TEST(TraceKinds, EachHasItsWord) {
  EXPECT_EQ(to_string(TraceKind::release), "release");
  EXPECT_EQ(to_string(TraceKind::user), "user");
  EXPECT_EQ(to_string(TraceKind::given_back), "given_back");
  EXPECT_EQ(to_string(TraceKind::lost), "lost");
  EXPECT_EQ(to_string(static_cast<TraceKind>(200)), "unknown");
}

}  // namespace
}  // namespace mauve
