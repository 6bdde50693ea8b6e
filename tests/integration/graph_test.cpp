// SPDX-License-Identifier: LGPL-3.0-or-later
// The running architecture as a graph.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST(Graph, ListsAllElementsInOneAnswer) {
  TrialDaemon daemon;

  const auto graph = daemon.ask("architecture.graph");

  EXPECT_EQ(graph["architecture"], "trial");
  ASSERT_EQ(graph["components"].size(), 2U);
  EXPECT_EQ(graph["components"][0]["ports"][0],
            Json::parse(R"({"name": "input", "kind": "read", "type": "double", "service": null})"));
  EXPECT_EQ(graph["components"][0]["ports"][1]["service"], "signal.write");
  EXPECT_EQ(graph["resources"].size(), 2U);
  EXPECT_EQ(graph["resources"][0]["poisoned"], false);
  EXPECT_FALSE(graph["resources"][0]["services"].empty());
  const auto machine = daemon.ask("object.get", {{"address", "first"}})["machine"];
  EXPECT_EQ(machine, Json::parse(R"({"initial": "update", "states": [
    {"name": "update", "kind": "execution", "transitions": [{"to": "period", "guarded": false}]},
    {"name": "period", "kind": "synchronization", "wait_ns": 2000000,
     "transitions": [{"to": "update", "guarded": false}]}]})"));
  EXPECT_THAT(daemon.ctl({"graph", "--svg"}).out,
              HasSubstr("<title>first.ports.output - signal.write</title>"));
}

}  // namespace
}  // namespace mauve::test
