// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/openrpc.h"

#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mauve/host/version.h"

namespace mauve::protocol {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const Json& document() {
  static const Json made = openrpc_document(methods());
  return made;
}

/// The method of the document, null if there is none.
Json method_called(const std::string& name) {
  const auto& all = document()["methods"];
  const auto found =
      std::ranges::find_if(all, [&](const Json& method) { return method["name"] == name; });
  return found == all.end() ? Json() : *found;
}

/// Calls `visit` with each object inside of a value, the value itself first.
template <typename Visit>
void each_object(const Json& value, Visit visit) {
  if (value.is_object()) visit(value);
  if (!value.is_structured()) return;
  for (const auto& part : value) each_object(part, visit);
}

/// The part of the document that a reference such as "#/components/schemas/Line" names.
const Json* find_reference(const std::string& reference) {
  if (!reference.starts_with("#/")) return nullptr;
  const Json::json_pointer pointer(reference.substr(1));
  return document().contains(pointer) ? &document()[pointer] : nullptr;
}

TEST(OpenRpc, NamesItsVersionAndThatOfTheProtocol) {
  EXPECT_EQ(document()["openrpc"], "1.2.6");
  EXPECT_EQ(document()["info"]["title"], "mauve");
  EXPECT_EQ(document()["info"]["version"], std::to_string(kVersion)) << "OpenRPC wants a text";
  EXPECT_TRUE(document()["info"]["license"]["name"].is_string());
}

TEST(OpenRpc, HoldsOnlyKeysThatTheSpecificationKnows) {
  const std::set<std::string> root = {"openrpc", "info", "methods", "components"};
  for (const auto& [key, value] : document().items()) EXPECT_TRUE(root.contains(key)) << key;
  const std::set<std::string> of_method = {"name",           "summary", "description",
                                           "paramStructure", "params",  "result",
                                           "x-role",         "x-lane",  "x-effect"};
  for (const auto& method : document()["methods"]) {
    for (const auto& [key, value] : method.items()) EXPECT_TRUE(of_method.contains(key)) << key;
  }
}

TEST(OpenRpc, DescribesEveryMethodOnce) {
  std::set<std::string> names;
  for (const auto& method : document()["methods"]) {
    EXPECT_TRUE(names.insert(method["name"]).second) << method["name"];
    EXPECT_GT(method["summary"].get<std::string>().size(), 5U) << method["name"];
    EXPECT_EQ(method["paramStructure"], "by-name");
  }
  EXPECT_EQ(names.size(), methods().size());
  EXPECT_THAT(names, Contains("rpc.discover"));
}

TEST(OpenRpc, GivesEveryParameterAndEveryResultASchema) {
  for (const auto& method : document()["methods"]) {
    std::set<std::string> names;
    for (const auto& param : method["params"]) {
      EXPECT_TRUE(names.insert(param["name"]).second) << param;
      EXPECT_TRUE(param["required"].is_boolean()) << param;
      ASSERT_TRUE(param["schema"].is_object()) << param;
      EXPECT_GT(param["schema"].size(), param["schema"].contains("description") ? 0U : 1U);
    }
    EXPECT_TRUE(method["result"]["name"].is_string());
    EXPECT_EQ(method["result"]["schema"]["type"], "object") << method["name"];
    EXPECT_FALSE(method["result"]["schema"]["properties"].empty()) << method["name"];
  }
}

TEST(OpenRpc, HasNoReferenceThatLeadsNowhere) {
  std::set<std::string> used;
  each_object(document(), [&](const Json& part) {
    const auto reference = part.find("$ref");
    if (reference == part.end() || !reference->is_string()) return;
    used.insert(reference->get<std::string>());
    EXPECT_NE(find_reference(*reference), nullptr) << *reference;
  });
  EXPECT_EQ(used.size(), document()["components"]["schemas"].size()) << "every schema is used";
  EXPECT_GT(used.size(), 30U);
  EXPECT_EQ(find_reference("#/components/schemas/Nothing"), nullptr);
}

TEST(OpenRpc, UsesOnlyTypesOfJsonSchema) {
  const std::set<std::string> types = {"string", "boolean", "integer", "number",
                                       "object", "array",   "null"};
  std::size_t seen = 0;
  const auto check = [&](const Json& part) {
    const auto type = part.find("type");
    if (type == part.end() || !type->is_string()) return;  // a field may be called "type" too
    ++seen;
    EXPECT_TRUE(types.contains(*type)) << part;
    if (*type == "array") {
      EXPECT_TRUE(part["items"].is_object()) << part;
    }
    for (const auto& name : part.value("required", Json::array())) {
      EXPECT_TRUE(part["properties"].contains(name)) << part;
    }
  };
  for (const auto& method : document()["methods"]) {
    for (const auto& param : method["params"]) each_object(param["schema"], check);
    each_object(method["result"]["schema"], check);
  }
  each_object(document()["components"]["schemas"], check);
  EXPECT_GT(seen, 500U);
}

TEST(OpenRpc, MakesSchemasOfTheTypesInTheTable) {
  const auto schema = method_called("core.swap")["params"];
  const auto param = [&](const std::string& name) {
    return *std::ranges::find_if(schema, [&](const Json& one) { return one["name"] == name; });
  };
  EXPECT_EQ(param("component")["required"], true);
  EXPECT_EQ(param("component")["schema"]["type"], "string");
  EXPECT_EQ(param("set")["required"], false);
  EXPECT_EQ(param("set")["schema"]["additionalProperties"], Json::object());
  EXPECT_EQ(param("state")["schema"]["enum"], Json({"drop"}));
  EXPECT_EQ(param("if_generation")["schema"]["minimum"], 0) << "every mutation takes it";
  EXPECT_THAT(param("deadline_ms")["description"], HasSubstr("Unit: ms."));

  const auto properties = method_called("status.get")["result"]["schema"]["properties"];
  EXPECT_THAT(properties["uptime_s"]["description"], HasSubstr("Unit: s."));
  EXPECT_EQ(properties["components"]["items"]["$ref"], "#/components/schemas/ComponentStatus");
  EXPECT_EQ(properties["recovered"]["anyOf"][1]["type"], "null");
  const auto required = method_called("status.get")["result"]["schema"]["required"];
  EXPECT_THAT(required, Contains("generation"));
  EXPECT_THAT(required, Not(Contains("saved")));
}

TEST(OpenRpc, OfOneMethodHoldsItsOwnSchemasOnly) {
  const auto one = openrpc_document({find_method("rules.list"), 1});

  ASSERT_EQ(one["methods"].size(), 1U);
  EXPECT_EQ(one["components"]["schemas"].size(), 2U) << one["components"];
  EXPECT_TRUE(one["components"]["schemas"].contains("Rule"));
  EXPECT_TRUE(one["components"]["schemas"].contains("AddressValue"));
}

}  // namespace
}  // namespace mauve::protocol
