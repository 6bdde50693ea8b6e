// SPDX-License-Identifier: LGPL-3.0-or-later
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "arch/build/load.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "unit/arch/architecture_text.h"
#include "unit/arch/sample_plugin.h"

namespace mauve::arch {
namespace {

using sample::with;

class FallbackCore : public testing::Test {
 protected:
  FallbackCore() { EXPECT_TRUE(catalog_.add(sample::make_plugin())); }

  plugin::Catalog catalog_;
  Problems problems_;
};

TEST_F(FallbackCore, IsKeptWithWhatItIsGiven) {
  const auto architecture =
      load(with("\"task\"",
                "\"fallback_core\": { \"core\": \"sample/attract\", \"properties\": "
                "{ \"core.gain\": 1 } }, \"task\""),
           catalog_, problems_);
  ASSERT_NE(architecture, nullptr);

  const auto& fallback = architecture->find_component("left")->fallback();

  ASSERT_TRUE(fallback);
  EXPECT_EQ(fallback->core.name, "sample/attract") << "the core of the component itself is fine";
  ASSERT_EQ(fallback->properties.size(), 1U);
  EXPECT_EQ(fallback->properties[0].first, "core.gain");
  EXPECT_EQ(fallback->properties[0].second, Value(1.0));
  EXPECT_FALSE(architecture->find_component("right")->fallback());
}

struct WrongFallback {
  std::string fallback_core, at, message, hint;
  Errc code;
};

const WrongFallback kWrongFallbacks[] = {
    {"\"sample/repell\"", "right.fallback_core", "repell", "sample/repel", Errc::unknown_name},
    {"\"other/repel\"", "right.fallback_core", "plugin \"other\" is not loaded",
     "add \"other\" to \"plugins\"", Errc::unknown_name},
    {"\"sample/stranger\"", "right.fallback_core", "calls sample/control/1",
     "cores that fit: sample/attract", Errc::type_mismatch},
    {"\"sample/throwing\"", "right.fallback_core", "constructor threw: out of order", "",
     Errc::hook_threw},
    {"{ \"core\": \"sample/repel\", \"properties\": { \"core.distnce\": 1 } }",
     "right.fallback_core.core.distnce", "right.fallback_core has no property of this name",
     "did you mean \"core.distance\"?", Errc::unknown_name},
    {"{ \"core\": \"sample/attract\", \"properties\": { \"core.gain\": 7 } }",
     "right.fallback_core.core.gain", "7 is above the maximum 2", "", Errc::invalid_value},
};

TEST_F(FallbackCore, IsCheckedLikeEveryCore) {
  for (const WrongFallback& wrong : kWrongFallbacks) {
    Problems problems;
    const auto text = with("\"start\": false", "\"fallback_core\": " + wrong.fallback_core);
    EXPECT_EQ(load(text, catalog_, problems), nullptr) << wrong.fallback_core;
    ASSERT_EQ(problems.size(), 1U) << wrong.fallback_core;
    const Problem problem = problems.sorted()[0];
    SCOPED_TRACE(wrong.fallback_core + " gave " + to_string(problem, "text"));
    EXPECT_EQ(problem.error.code, wrong.code);
    EXPECT_EQ(problem.error.at, wrong.at);
    EXPECT_NE(problem.error.message.find(wrong.message), std::string::npos);
    EXPECT_NE(problem.error.hint.find(wrong.hint), std::string::npos);
    EXPECT_EQ(problem.where.line, 22U);
  }
}

TEST_F(FallbackCore, IsCheckedBesideAComponentThatCannotBeMade) {
  std::string text = with("\"start\": false", "\"fallback_core\": \"sample/repell\"");
  text = with("\"sample/periodic\"", "\"sample/periodc\"", text);

  EXPECT_EQ(load(text, catalog_, problems_), nullptr);

  ASSERT_EQ(problems_.size(), 2U);
  EXPECT_EQ(problems_.sorted()[1].error.at, "right.fallback_core");
}

}  // namespace
}  // namespace mauve::arch
