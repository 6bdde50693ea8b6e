// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/describe.h"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arch/build/load.h"
#include "arch/text/value_json.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "unit/arch/architecture_text.h"
#include "unit/arch/diff_fixture.h"
#include "unit/arch/sample_plugin.h"

namespace mauve::arch {
namespace {

class Describe : public testing::Test {
 protected:
  Describe() { EXPECT_TRUE(catalog_.add(sample::make_plugin())); }

  std::unique_ptr<Architecture> made(std::string_view text) {
    Problems problems;
    auto architecture = load(text, catalog_, problems);
    for (const Problem& problem : problems.sorted()) ADD_FAILURE() << to_string(problem, "text");
    return architecture;
  }
  std::string exported(const Architecture& architecture) {
    return to_json_text(describe(architecture, catalog_));
  }

  plugin::Catalog catalog_;
};

TEST_F(Describe, WritesTheFormOfTheFileAndLeavesDefaultsOut) {
  const auto architecture = made(sample::kArchitecture);
  ASSERT_NE(architecture, nullptr);

  const Value value = describe(*architecture, catalog_);

  EXPECT_EQ(*value.find("schema"), Value("mauve/architecture/1"));
  EXPECT_EQ(*value.find("resources")->find("pose"),
            Value(Value::Object{{"type", "shared_data"}, {"data", "pose/1"}}));
  EXPECT_EQ(*value.find("resources")->find("relay")->find("lock_budget"), Value("50us"));
  EXPECT_EQ(*value.find("components")->find("right"),
            Value(Value::Object{{"type", "sample/bare"},
                                {"core", "sample/repel"},
                                {"fsm", "sample/periodic"},
                                {"start", false}}));
  const Value& left = *value.find("components")->find("left");
  EXPECT_EQ(*left.find("ports")->find("pose"),
            Value(Value::Object{{"connect", "pose.read"}, {"max_age", "50ms"}}));
  EXPECT_EQ(*left.find("task")->find("stack"), Value("128KiB"));
  EXPECT_EQ(left.find("properties")->find("core.steps"), nullptr);
}

TEST_F(Describe, GivesTheSameSystemWhenReadAgain) {
  const auto first = made(sample::kArchitecture);
  ASSERT_NE(first, nullptr);
  const std::string text = exported(*first);

  const auto second = made(text);

  ASSERT_NE(second, nullptr) << text;
  EXPECT_EQ(exported(*second), text);
  ASSERT_EQ(second->components().size(), 2U);
  EXPECT_EQ(second->components()[0]->task(), first->components()[0]->task());
}

TEST_F(Describe, WritesWhatRunsAndNotWhatTheFileSaid) {
  const auto architecture = made(sample::kArchitecture);
  ASSERT_NE(architecture, nullptr);
  ASSERT_TRUE(architecture->find_component("left")->disconnect("scan"));
  ASSERT_TRUE(architecture->find_component("left")->replace_core(*catalog_.core("sample/repel")));

  const Value value = describe(*architecture, catalog_, [](const ComponentBase&) { return false; });

  const Value& left = *value.find("components")->find("left");
  EXPECT_EQ(left.find("ports")->find("scan"), nullptr);
  EXPECT_EQ(*left.find("core"), Value("sample/repel"));
  EXPECT_EQ(value.find("components")->find("right")->find("start"), nullptr);
}

Value random_policy(std::mt19937& random) {
  if (random() % 2 == 0) return random() % 2 == 0 ? "stop" : "fallback";
  return Value::Object{{"restart", static_cast<std::int64_t>(random() % 5 + 1)},
                       {"back_off", std::to_string(random() % 500) + "ms"}};
}

/// A text of up to eight characters that JSON escapes, or writes in more than one byte.
std::string random_text(std::mt19937& random) {
  constexpr std::array<std::string_view, 8> kPieces{"a",  " ",  "\"",     "\\",
                                                    "\n", "\t", "\u00e4", "\x7f"};
  std::string text;
  for (auto i = random() % 9; i > 0; --i) text += kPieces[random() % kPieces.size()];
  return text;
}

/// A finite number of any size.
double random_number(std::mt19937& random) {
  const double digits = static_cast<double>(random()) - 2147483648.0;
  return std::ldexp(digits, static_cast<int>(random() % 1900) - 1000);
}

/// Properties of a component: numbers, texts and structures.
Value::Object random_properties(std::mt19937& random) {
  const auto chance = [&] { return random() % 2 == 0; };
  Value::Object properties{{"fsm.period", std::to_string(random() % 5000 + 10) + "us"}};
  if (chance()) properties.emplace_back("core.gain", static_cast<double>(random() % 2001) / 1000);
  if (chance()) properties.emplace_back("core.steps", static_cast<std::int64_t>(random() % 9));
  if (chance()) properties.emplace_back("shell.device", random_text(random));
  if (chance()) {
    properties.emplace_back(
        "core.home", Value::Object{{"x", random_number(random)}, {"y", random_number(random)}});
  }
  return properties;
}

/// One random architecture of the sample plugin.
Value random_architecture(std::mt19937& random) {
  const auto chance = [&] { return random() % 2 == 0; };
  Value::Object resources;
  Value::Object components;
  const unsigned count = random() % 4 + 1;
  for (unsigned i = 0; i < count; ++i) {
    const std::string n = std::to_string(i);
    resources.emplace_back(
        "pose" + n,
        Value::Object{{"type", chance() ? "shared_data" : "ring_buffer"}, {"data", "pose/1"}});
    Value::Object relay{{"type", "sample/relay"}};
    if (chance()) relay.emplace_back("ports", Value::Object{{"next", "pose" + n + ".write"}});
    if (chance()) relay.emplace_back("properties", Value::Object{{"interface.strict", chance()}});
    if (chance()) relay.emplace_back("lock_budget", std::to_string(random() % 900 + 1) + "us");
    resources.emplace_back("relay" + n, std::move(relay));
    Value::Object ports;
    if (chance()) {
      ports.emplace_back("pose",
                         Value::Object{{"connect", "relay" + n + ".read"},
                                       {"max_age", std::to_string(random() % 99 + 1) + "ms"}});
    }
    if (chance()) ports.emplace_back("command", "pose" + n + ".write");
    Value::Object fallback_properties;
    if (chance()) fallback_properties.emplace_back("core.gain", 1.5);
    Value::Object task{{"priority", static_cast<std::int64_t>(random() % 90 + 1)}};
    if (chance()) task.emplace_back("offset", std::to_string(random() % 100'000) + "ns");
    if (chance()) task.emplace_back("on_overrun", chance() ? "fallback" : "stop");
    if (task.back().first == "on_overrun" && chance()) task.emplace_back("overrun_limit", 2);
    if (chance()) task.emplace_back("watchdog", std::to_string(random() % 100 + 1) + "ms");
    if (chance()) task.emplace_back("on_fault", random_policy(random));
    Value fallback = chance()
                         ? Value("sample/repel")
                         : Value(Value::Object{{"core", "sample/attract"},
                                               {"properties", std::move(fallback_properties)}});
    components.emplace_back("c" + n, Value::Object{{"type", "sample/control"},
                                                   {"properties", random_properties(random)},
                                                   {"ports", std::move(ports)},
                                                   {"fallback_core", std::move(fallback)},
                                                   {"task", std::move(task)},
                                                   {"start", chance()}});
  }
  return Value::Object{{"schema", kSchema},
                       {"name", "random"},
                       {"resources", std::move(resources)},
                       {"components", std::move(components)}};
}

TEST_F(Describe, GivesASystemThatApplyLeavesAsItIsForAnyArchitecture) {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    const std::string written = to_json_text(random_architecture(random));
    const auto first = made(written);
    ASSERT_NE(first, nullptr) << written;
    const std::string text = exported(*first);
    const auto second = made(text);
    ASSERT_NE(second, nullptr) << text;
    ASSERT_EQ(exported(*second), text);
    for (std::size_t i = 0; i < first->components().size(); ++i) {
      ASSERT_EQ(second->components()[i]->task(), first->components()[i]->task()) << written;
      ASSERT_EQ(describe_fallback(second->components()[i]->fallback()),
                describe_fallback(first->components()[i]->fallback()));
    }
    const Difference applied = compare(*first, *second);
    ASSERT_EQ(said(applied.lines), std::vector<std::string>{}) << text;
    ASSERT_TRUE(empty(applied.change)) << text;
  }
}

}  // namespace
}  // namespace mauve::arch
