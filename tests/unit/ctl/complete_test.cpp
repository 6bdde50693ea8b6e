// SPDX-License-Identifier: LGPL-3.0-or-later
#include "complete.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "unit/ctl/fake_server.h"

namespace mauve::ctl {
namespace {

using Words = std::vector<std::string>;

void serve_names(Peer& peer) {
  peer.say(kHello);
  for (auto request = peer.hear(); !request.id.is_null(); request = peer.hear()) {
    if (request.method == "component.list") {
      peer.answer(request,
                  protocol::Json::parse(R"({"items":[{"name":"control"},{"name":"laser"}]})"));
    } else if (request.method == "resource.list") {
      peer.answer(request, protocol::Json::parse(
                               R"({"items":[{"name":"scan","services":["read","write"]}]})"));
    } else if (request.method == "core.list") {
      peer.answer(request,
                  {{"items", {{{"name", "for_" + request.params["for"].get<std::string>()}}}}});
    } else if (request.method == "rules.list") {
      peer.answer(request, protocol::Json::parse(R"({"items":[{"name":"gnss_lost"}]})"));
    } else {
      peer.answer(
          request,
          protocol::Json::parse(
              R"({"address":"control","properties":[{"name":"core.gain"},{"name":"fsm.pace"}],
                        "observables":[{"name":"core.goals"}],
                        "ports":[{"name":"scan"}]})"));
    }
  }
}

TEST(Completion, OffersCommands) {
  EXPECT_EQ(completions({"st"}), (Words{"start", "stats", "status", "stop"}));
  EXPECT_GT(completions({""}).size(), 15U);
}

TEST(Completion, OffersTheOptionsOfTheCommandAndTheGlobalOnes) {
  const Words words = completions({"swap-core", "--"});

  EXPECT_NE(std::find(words.begin(), words.end(), "--in-place"), words.end());
  EXPECT_NE(std::find(words.begin(), words.end(), "--socket"), words.end());
  EXPECT_EQ(completions({"status", "--in"}), Words{});
  EXPECT_EQ(completions({"connect", "--max"}), Words{"--max-age"});
}

TEST(Completion, OffersKindsAndLevels) {
  EXPECT_EQ(completions({"list", "p"}), (Words{"plugins", "ports"}));
  EXPECT_EQ(completions({"logs", "--level", ""}), (Words{"debug", "error", "info", "warn"}));
}

TEST(Completion, AsksTheDaemonForNames) {
  FakeServer server(serve_names, 8);

  EXPECT_EQ(completions({"--socket", server.path(), "start", "l"}), Words{"laser"});
  EXPECT_EQ(completions({"--socket", server.path(), "swap-core", "arm", ""}), Words{"for_arm"});
  EXPECT_EQ(completions({"--socket", server.path(), "get", ""}),
            (Words{"control", "laser", "scan"}));
  EXPECT_EQ(completions({"--socket", server.path(), "get", "control.c"}),
            (Words{"control.core.gain", "control.core.goals"}));
  EXPECT_EQ(completions({"--socket", server.path(), "set", "control."}),
            (Words{"control.core.gain", "control.fsm.pace"}));
  EXPECT_EQ(completions({"--socket", server.path(), "get", "control.p"}),
            Words{"control.ports.scan"});
  EXPECT_EQ(completions({"--socket", server.path(), "connect", "control.ports.scan", "s"}),
            (Words{"scan.read", "scan.write"}));
  EXPECT_EQ(completions({"--socket", server.path(), "rules", "g"}), Words{"gnss_lost"});
}

TEST(Completion, IsSilentWithoutDaemon) {
  EXPECT_EQ(completions({"--socket", "/nowhere", "start", ""}), Words{});
  EXPECT_EQ(completions({}), Words{});
}

}  // namespace
}  // namespace mauve::ctl
