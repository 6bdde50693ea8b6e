// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/complete.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "support/temp_dir.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

using Words = std::vector<std::string>;

/// The words alone, as every shell inserts them; a slow machine has time for the answers.
Words completed(const Words& words) {
  Words result;
  for (const auto& one : complete(words, std::chrono::minutes(1)).candidates) {
    result.push_back(one.word);
  }
  return result;
}

/// Holds loaded.so, extra.so and a file that is no plugin.
std::string plugin_dir() {
  static const test::TempDir folder;
  for (const char* name : {"loaded.so", "extra.so", "notes.txt"})
    std::ofstream(folder / name) << "";
  return folder.path().string();
}

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
      const auto wanted = request.params.value("for", std::string("all"));
      peer.answer(request, {{"items", {{{"name", "for_" + wanted}}}}});
    } else if (request.method == "architecture.graph") {
      peer.answer(request, protocol::Json::parse(R"({
          "components":[{"name":"control","ports":[{"name":"scan","kind":"read","type":["s/1"]}]}],
          "resources":[
            {"name":"scan","ports":[],"services":[{"name":"read","kind":"read","type":["s/1"]},
                                                  {"name":"write","kind":"write","type":["s/1"]}]},
            {"name":"pose","services":[{"name":"read","kind":"read","type":["p/1"]}]}]})"));
    } else if (request.method == "plugin.list") {
      peer.answer(request, protocol::Json::parse(R"({"items":[{"name":"loaded"}]})"));
    } else if (request.method == "daemon.doctor") {
      Json dirs = Json::array();
      for (const std::string& path : {plugin_dir(), std::string("/no/such")}) {
        dirs.push_back(Json{{"path", path}});
      }
      peer.answer(request, Json{{"plugin_dirs", dirs}});
    } else if (request.method == "config.history") {
      peer.answer(request,
                  protocol::Json::parse(R"({"items":[{"generation":42},{"generation":41}]})"));
    } else if (request.method == "trace.list") {
      peer.answer(request, protocol::Json::parse(R"({"items":[{"name":"flight-0001-fault"}]})"));
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
  EXPECT_EQ(completed({"st"}), (Words{"start", "stats", "status", "stop"}));
  EXPECT_GT(completed({""}).size(), 15U);
}

TEST(Completion, OffersTheOptionsOfTheCommandAndTheGlobalOnes) {
  const Words words = completed({"swap-core", "--"});

  EXPECT_NE(std::find(words.begin(), words.end(), "--in-place"), words.end());
  EXPECT_NE(std::find(words.begin(), words.end(), "--socket"), words.end());
  EXPECT_EQ(completed({"status", "--in"}), Words{});
  EXPECT_EQ(completed({"connect", "--max"}), Words{"--max-age"});
}

TEST(Completion, OffersKindsAndLevels) {
  EXPECT_EQ(completed({"list", "p"}), (Words{"plugins", "ports"}));
  EXPECT_EQ(completed({"logs", "--level", ""}), (Words{"debug", "error", "info", "warn"}));
}

TEST(Completion, AsksTheDaemonForNames) {
  FakeServer server(serve_names, 11);

  EXPECT_EQ(completed({"--socket", server.path(), "start", "l"}), Words{"laser"});
  EXPECT_EQ(completed({"--socket", server.path(), "swap-core", "arm", ""}), Words{"for_arm"});
  EXPECT_EQ(completed({"--socket", server.path(), "quarantine", "release", ""}), Words{"for_all"});
  EXPECT_EQ(completed({"--socket", server.path(), "get", ""}), (Words{"control", "laser", "scan"}));
  EXPECT_EQ(completed({"--socket", server.path(), "get", "control.c"}),
            (Words{"control.core.gain", "control.core.goals"}));
  EXPECT_EQ(completed({"--socket", server.path(), "set", "control."}),
            (Words{"control.core.gain=", "control.fsm.pace="}));
  EXPECT_EQ(completed({"--socket", server.path(), "set", "c"}), Words{"control."});
  EXPECT_EQ(completed({"--socket=" + server.path(), "stop", "la"}), Words{"laser"});
  EXPECT_EQ(completed({"--socket", server.path(), "get", "control.p"}),
            Words{"control.ports.scan"});
  EXPECT_EQ(completed({"--socket", server.path(), "connect", "control.ports.scan", "s"}),
            Words{"scan.read"});
  EXPECT_EQ(completed({"--socket", server.path(), "rules", "g"}), Words{"gnss_lost"});
}

TEST(Completion, OffersWhatTheCommandAccepts) {
  FakeServer server(serve_names, 7);
  const std::string socket = "--socket=" + server.path();

  EXPECT_EQ(completed({socket, "load", ""}), Words{"extra"}) << "those that are not loaded";
  EXPECT_EQ(completed({socket, "unload", ""}), Words{"loaded"});
  EXPECT_EQ(completed({socket, "connect", "other.ports.x", ""}),
            (Words{"pose.read", "scan.read", "scan.write"}));
  EXPECT_EQ(completed({socket, "rollback", ""}), (Words{"41", "42"}));
  EXPECT_EQ(completed({socket, "trace", "dump", ""}), Words{"flight-0001-fault"});
  EXPECT_EQ(completed({socket, "swap-core", "control", "a/b", "--set", ""}), Words{"gain="});
  EXPECT_EQ(completed({socket, "swap-core", "control", "a/b", "--set=g"}), Words{"--set=gain="});
  EXPECT_EQ(completed({"help", "swap"}), Words{"swap-core"});
}

TEST(Completion, OffersTheWordsThatAnOptionTakes) {
  EXPECT_EQ(completed({"apply", "rover.json", "--sync", ""}), (Words{"barrier", "cut"}));
  EXPECT_EQ(completed({"--color", "a"}), (Words{"always", "auto"}));
  EXPECT_EQ(completed({"reload", "a", "--state", ""}), Words{"drop"});
  EXPECT_EQ(completed({"logs", "--level=w"}), Words{"--level=warn"});
  EXPECT_EQ(completed({"completion", ""}), (Words{"bash", "fish", "zsh"}));
  EXPECT_EQ(completed({"new", "co"}), (Words{"component", "core"}));
  EXPECT_EQ(completed({"trace", "st"}), (Words{"start", "status", "stop"}));
  EXPECT_EQ(completed({"log", ""}), Words{"level"});
  EXPECT_EQ(completed({"log", "level", "d"}), (Words{"debug", "default"}));
  EXPECT_EQ(completed({"lock", ""}), (Words{"all", "none", "params", "topology"}));
  EXPECT_EQ(completed({"convert-trace", "a", "--format", ""}), (Words{"chrome", "ctf", "mtrace"}));
  EXPECT_EQ(completed({"--socket", "/nowhere", "stats", ""}), Words{"reset"});
  EXPECT_EQ(completed({"status", "--json="}), Words{});
}

TEST(Completion, LeavesFilesToTheShell) {
  EXPECT_TRUE(complete({"apply", ""}).files);
  EXPECT_TRUE(complete({"record", "a.read", "-o", ""}).files);
  EXPECT_TRUE(complete({"--socket", ""}).files);
  EXPECT_FALSE(complete({"apply", "rover.json", ""}).files);
  EXPECT_FALSE(complete({"start", ""}).files);
}

TEST(Completion, PrintsALineForEachCandidate) {
  EXPECT_EQ(completion_lines({{{"a", "what it is"}, {"b", ""}}, false}), "a\twhat it is\nb\n");
  EXPECT_EQ(completion_lines({{}, true}), ":files\n");
  EXPECT_EQ(completion_lines({{{"a\nb", "\x1b[31m"}}, false}), "a?b\t?[31m\n");
}

TEST(CompletionScripts, AreThereForThreeShells) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const auto outcome = run("/nowhere", {"completion", shell});
    EXPECT_EQ(outcome.exit, 0);
    EXPECT_NE(outcome.out.find("mauvectl __complete"), std::string::npos) << shell;
    const auto json = protocol::Json::parse(run("/nowhere", {"--json", "completion", shell}).out);
    EXPECT_EQ(json["script"], outcome.out);
  }
}

TEST(Completion, IsSilentWithoutDaemon) {
  EXPECT_EQ(completed({"--socket", "/nowhere", "start", ""}), Words{});
  EXPECT_EQ(completed({}), Words{});
}

}  // namespace
}  // namespace mauve::ctl
