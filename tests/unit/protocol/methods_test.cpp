// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/methods.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace mauve::protocol {
namespace {

std::optional<Fault> check(std::string_view method, const Json& params) {
  const Method* found = find_method(method);
  EXPECT_NE(found, nullptr) << method;
  return check_params(*found, params);
}

TEST(Methods, HaveOneNameEach) {
  std::set<std::string_view> names;
  for (const Method& method : methods()) EXPECT_TRUE(names.insert(method.name).second);
}

TEST(Methods, AreFoundByNameAndAlias) {
  ASSERT_NE(find_method("status"), nullptr);
  EXPECT_EQ(find_method("status")->name, "status.get");
  EXPECT_EQ(find_method("nothing"), nullptr);
}

TEST(Methods, ServeOnlyPingAndStopOutOfBand) {
  for (const Method& method : methods()) {
    EXPECT_EQ(method.out_of_band, method.name == "ping" || method.name == "component.stop");
  }
}

TEST(UnknownMethod, NamesTheNearest) {
  const Fault fault = unknown_method("core.swpa");

  EXPECT_EQ(fault.code, kUnknownMethod);
  EXPECT_EQ(fault.hint, "did you mean 'core.swap'?");
  EXPECT_FALSE(unknown_method("frobnicate").hint.empty());
}

TEST(CheckParams, AcceptsWhatTheTableSays) {
  EXPECT_FALSE(check("ping", Json::object()));
  EXPECT_FALSE(check("core.swap", {{"component", "a"}, {"core", "b/c"}, {"set", {{"k", 1}}}}));
  EXPECT_FALSE(check("component.stop", {{"all", true}}));
  EXPECT_FALSE(check("watch.subscribe", {{"addresses", {"a.read", "b.read"}}}));
}

TEST(CheckParams, AcceptsTheArgumentsOfEveryMutation) {
  const Json params = {
      {"port", "a.ports.b"}, {"if_generation", 3}, {"reason", "test"}, {"deadline_ms", 100}};

  EXPECT_FALSE(check("port.disconnect", params));
  EXPECT_TRUE(check("param.get", {{"address", "a"}, {"if_generation", 3}}));
}

TEST(CheckParams, RefusesAnUnknownArgumentWithTheNearestName) {
  const auto fault = check("core.swap", {{"component", "a"}, {"core", "b"}, {"inplace", true}});

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, kInvalidParams);
  EXPECT_EQ(fault->where, "core.swap");
  EXPECT_EQ(fault->hint, "did you mean 'in_place'?");
}

TEST(CheckParams, RefusesAMissingArgument) {
  const auto fault = check("port.connect", {{"port", "a.ports.b"}});

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->message, "argument 'service' is missing");
}

TEST(CheckParams, RefusesAnotherJsonType) {
  EXPECT_TRUE(check("param.get", {{"address", 1}}));
  EXPECT_TRUE(check("component.stop", {{"all", "yes"}}));
  EXPECT_TRUE(check("watch.unsubscribe", {{"sub", -1}}));
  EXPECT_TRUE(check("watch.unsubscribe", {{"sub", 1.5}}));
  EXPECT_TRUE(check("param.set", {{"values", Json::array()}}));
  EXPECT_TRUE(check("watch.subscribe", {{"addresses", {"a", 1}}}));
  EXPECT_TRUE(check("watch.subscribe", {{"addresses", nullptr}}));
}

}  // namespace
}  // namespace mauve::protocol
