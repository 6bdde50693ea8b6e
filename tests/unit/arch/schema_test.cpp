// SPDX-License-Identifier: LGPL-3.0-or-later
// The schema for editors and the parser know the same keys, words and limits; every file of etc/
// is accepted.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "arch/parse/parse.h"
#include "arch/text/json.h"
#include "base/duration.h"
#include "mauve/detail/resource_lock.h"
#include "mauve/host/value.h"

namespace mauve::arch {
namespace {

constexpr const char* kSchemaFile = MAUVE_SOURCE_DIR "/etc/architecture.schema.json";

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

const Value& schema() {
  static const Value value = [] {
    Problems problems;
    const auto node = parse_json(text_of(kSchemaFile), problems);
    for (const Problem& problem : problems.sorted())
      ADD_FAILURE() << to_string(problem, kSchemaFile);
    return node ? to_value(*node) : Value{};
  }();
  return value;
}

const Value& part(const Value& value, std::initializer_list<std::string_view> path) {
  static const Value none;
  const Value* found = &value;
  for (const std::string_view name : path) {
    found = found->find(name);
    if (found == nullptr) {
      ADD_FAILURE() << "the schema has no " << name;
      return none;
    }
  }
  return *found;
}

std::set<std::string> keys_of(const Value& object) {
  std::set<std::string> keys;
  if (const auto* members = object.get_if<Value::Object>()) {
    for (const auto& [key, member] : *members) keys.insert(key);
  }
  return keys;
}

// A file with `inside` at one of its levels.
std::string file_with(const std::string& level, const std::string& inside) {
  const std::string head = R"("schema": "mauve/architecture/1", "name": "x")";
  if (level == "root") return "{" + head + ", " + inside + "}";
  if (level == "resource")
    return "{" + head + R"(, "resources": {"a": {"type": "b", )" + inside + "}}}";
  if (level == "rule")
    return "{" + head + R"(, "rules": [{"name": "a", "when": "a.b", "do": "c", )" + inside + "}]}";
  const std::string component = "{" + head + R"(, "components": {"a": {"type": "b", )";
  if (level == "component") return component + inside + "}}}";
  if (level == "fallback") {
    return component + R"("fallback_core": {"core": "a/b", )" + inside + "}}}}";
  }
  if (level == "restart") {
    return component + R"("task": {"on_fault": {"restart": 1, )" + inside + "}}}}}";
  }
  if (level == "task") return component + R"("task": {)" + inside + "}}}}";
  return component + R"("ports": {"p": {"connect": "r.s", )" + inside + "}}}}}";
}

std::vector<Problem> problems_of(const std::string& text) {
  Problems problems;
  static_cast<void>(parse(text, problems));
  return problems.sorted();
}

// The keys that the parser knows: its hint for a key like no other lists them.
std::set<std::string> parsed_keys(const std::string& level) {
  const auto problems = problems_of(file_with(level, R"("zzzzzzzzzzzz": 0)"));
  if (problems.size() != 1U) {
    ADD_FAILURE() << level;
    return {};
  }
  std::set<std::string> keys;
  std::istringstream list(problems[0].error.hint.substr(std::string("there is: ").size()));
  for (std::string key; std::getline(list >> std::ws, key, ',');) {
    const auto refused = problems_of(file_with(level, "\"" + key + "\": null"));
    const bool unsupported =
        std::any_of(refused.begin(), refused.end(),
                    [](const Problem& problem) { return problem.error.code == Errc::unsupported; });
    if (!unsupported) keys.insert(key);
  }
  return keys;
}

TEST(Schema, KnowsTheKeysThatTheParserKnows) {
  EXPECT_EQ(keys_of(part(schema(), {"properties"})), parsed_keys("root"));
  for (const std::string level :
       {"resource", "component", "task", "connection", "fallback", "restart", "rule"}) {
    EXPECT_EQ(keys_of(part(schema(), {"definitions", level, "properties"})), parsed_keys(level))
        << level;
  }
}

// The words that the parser knows where this step has a key like no other.
std::set<std::string> parsed_in_step(const std::string& begin) {
  const auto problems =
      problems_of(R"({"schema": "mauve/architecture/1", "name": "x", "transactions": {"t": [{)" +
                  begin + R"("zzzzzzzzzzzz": 0}]}})");
  std::set<std::string> words;
  for (const Problem& problem : problems) {
    const std::string& hint = problem.error.hint;
    if (!hint.starts_with("there is: ")) continue;
    std::istringstream list(hint.substr(std::string("there is: ").size()));
    for (std::string word; std::getline(list >> std::ws, word, ',');) words.insert(word);
  }
  return words;
}

TEST(Schema, KnowsTheStepsThatTheParserKnows) {
  const std::map<std::string, std::string> subjects{{"disconnect", "a.ports.b"},
                                                    {"connect", "a.ports.b"},
                                                    {"set", "a.core.b"},
                                                    {"swap", "a"},
                                                    {"stop", "a"},
                                                    {"start", "a"}};
  std::set<std::string> actions;
  const Value& forms = part(schema(), {"definitions", "steps", "items", "oneOf"});
  for (const Value& form : *forms.get_if<Value::Array>()) {
    const auto keys = keys_of(part(form, {"properties"}));
    const auto action = std::find_if(keys.begin(), keys.end(),
                                     [&](const auto& key) { return subjects.contains(key); });
    ASSERT_NE(action, keys.end());
    actions.insert(*action);
    EXPECT_EQ(keys, parsed_in_step("\"" + *action + "\": \"" + subjects.at(*action) + "\", "))
        << *action;
    EXPECT_EQ(part(form, {"additionalProperties"}), Value(false)) << *action;
  }
  EXPECT_EQ(actions, parsed_in_step(""));
}

TEST(Schema, RefusesUnknownKeysEverywhere) {
  EXPECT_EQ(part(schema(), {"additionalProperties"}), Value(false));
  for (const std::string level :
       {"resource", "component", "task", "connection", "fallback", "restart", "rule"}) {
    EXPECT_EQ(part(schema(), {"definitions", level, "additionalProperties"}), Value(false));
  }
}

TEST(Schema, HasTheLimitsAndDefaultsOfTheRuntime) {
  const Value& task = part(schema(), {"definitions", "task", "properties"});
  const TaskAttributes defaults;

  EXPECT_EQ(part(schema(), {"properties", "schema", "const"}), Value(kSchema));
  EXPECT_EQ(part(task, {"priority", "minimum"}), Value(kLowestPriority));
  EXPECT_EQ(part(task, {"priority", "maximum"}), Value(kHighestPriority));
  EXPECT_EQ(part(task, {"priority", "default"}), Value(defaults.priority));
  EXPECT_EQ(part(task, {"cpus", "items", "maximum"}), Value(kHighestCpu));
  const Value& restart = part(schema(), {"definitions", "restart", "properties"});
  EXPECT_EQ(part(restart, {"per", "default"}), Value(format_duration(defaults.on_fault.per)));
  EXPECT_EQ(part(restart, {"back_off", "default"}),
            Value(format_duration(defaults.on_fault.back_off)));
  EXPECT_EQ(part(task, {"on_overrun", "default"}), Value(to_string(defaults.on_overrun)));
  EXPECT_EQ(part(task, {"overrun_limit", "default"}),
            Value(static_cast<std::int64_t>(defaults.overrun_limit)));
  const Value& rule = part(schema(), {"definitions", "rule", "properties"});
  const rules::Timing timing;
  EXPECT_EQ(part(rule, {"per_hour", "maximum"}), Value(static_cast<std::int64_t>(kMostPerHour)));
  EXPECT_EQ(part(rule, {"per_hour", "default"}), Value(static_cast<std::int64_t>(timing.per_hour)));
  EXPECT_EQ(part(rule, {"cool_down", "default"}), Value("1s"));
  EXPECT_EQ(part(rule, {"when_unknown", "default"}), Value(to_string(rules::Unknown::hold)));
  EXPECT_EQ(timing.cool_down, 1s);
  EXPECT_EQ(part(schema(), {"definitions", "condition", "maxLength"}),
            Value(static_cast<std::int64_t>(rules::Condition::kLongest)));
  for (const OnOverrun policy :
       {OnOverrun::catch_up, OnOverrun::skip, OnOverrun::stop, OnOverrun::fallback}) {
    const auto& words = *part(task, {"on_overrun", "enum"}).get_if<Value::Array>();
    EXPECT_NE(std::find(words.begin(), words.end(), Value(to_string(policy))), words.end());
  }
}

TEST(Schema, ExplainsEveryKey) {
  for (const std::string level : {"resource", "component", "task", "rule"}) {
    const Value& keys = part(schema(), {"definitions", level, "properties"});
    for (const auto& [key, member] : *keys.get_if<Value::Object>()) {
      const bool refers = member.find("$ref") != nullptr && key == "ports";
      EXPECT_TRUE(refers || (key == "task") || member.find("description") != nullptr) << key;
    }
  }
}

TEST(Schema, SaysHowLongAResourceMayBeDeclaredToBeHeld) {
  const Value& key = part(schema(), {"definitions", "resource", "properties", "lock_budget"});
  const std::string limit = "at most " + format_duration(kLongestBudget);
  EXPECT_NE(part(key, {"description"}).get_if<std::string>()->find(limit), std::string::npos);
}

TEST(Schema, CallsCrossCoreReservedUntilItHasAnEffect) {
  const Value& key = part(schema(), {"definitions", "resource", "properties", "cross_core"});
  const Value& text = part(key, {"description"});
  EXPECT_TRUE(text.get_if<std::string>()->starts_with("Reserved: accepted, without effect"));
}

TEST(ArchitectureFiles, OfTheProjectAreAcceptedByTheParser) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MAUVE_SOURCE_DIR "/etc")) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".json" || name.ends_with(".schema.json")) continue;
    ++files;
    for (const Problem& problem : problems_of(text_of(entry.path()))) {
      ADD_FAILURE() << to_string(problem, name);
    }
  }
  RecordProperty("files", static_cast<int>(files));
  EXPECT_GE(files, 5U);
}

}  // namespace
}  // namespace mauve::arch
