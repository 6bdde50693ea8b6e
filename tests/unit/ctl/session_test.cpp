// SPDX-License-Identifier: LGPL-3.0-or-later
// Whole commands against a fake server: what is asked, what is printed, which exit code.
#include "cli/session.h"

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mauve/plugin.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

const Json kSwapReceipt = Json::parse(R"({"generation": 42, "changed": true, "state": "applied",
  "commit": 7, "attempts": 1, "components":
  [{"name": "control", "pause_ns": 38, "missed": 0, "bytes": 0}]})");

TEST(SwapCore, AsksWithEverythingThatWasSaid) {
  const Scene scene({"swap-core", "control", "guidance/finite_time", "--set", "gain=0.3", "--set",
                     "mode=fast", "--in-place", "--state", "drop", "--if-generation", "41",
                     "--reason", "test", "--timeout", "20s"},
                    kSwapReceipt);

  ASSERT_EQ(scene.asked.size(), 1U);
  EXPECT_EQ(scene.asked[0].method, "core.swap");
  EXPECT_EQ(scene.asked[0].params, Json::parse(R"({"component": "control",
    "core": "guidance/finite_time", "set": {"gain": 0.3, "mode": "fast"}, "in_place": true,
    "state": "drop", "if_generation": 41, "reason": "test", "deadline_ms": 20000})"));
  EXPECT_EQ(scene.outcome.exit, 0);
  EXPECT_EQ(scene.outcome.out, "swapped control: pause 38 ns, 0 releases missed (generation 42)\n");
}

TEST(Wait, TriesAgainUntilADaemonAnswers) {
  // The first connection ends without a greeting, as when the daemon is not ready.
  int connections = 0;
  FakeServer server(
      [&](Peer& peer) {
        if (++connections == 1) return;
        peer.say(kHello);
        const auto request = peer.hear();
        peer.answer(request, {{"ok", true}});
        peer.wait_for_the_end();
      },
      2);

  const Outcome outcome = run(server.path(), {"ping", "--wait", "60s"});

  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(connections, 2);
}

TEST(Wait, WithoutItADaemonThatDoesNotAnswerIsAnErrorAtOnce) {
  EXPECT_EQ(run("/nowhere/mauve.sock", {"ping"}).exit, 7);
  const Outcome waited = run("/nowhere/mauve.sock", {"ping", "--wait", "1ms"});
  EXPECT_EQ(waited.exit, 7);
  EXPECT_NE(waited.err.find("no mauved answers there; waited 1ms"), std::string::npos)
      << waited.err;
  EXPECT_NE(waited.err.find("mauvectl explain unreachable"), std::string::npos) << waited.err;
}

TEST(ChangingCommands, AskForNothingMoreWhereTheyOnlyLook) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> looks = {
      {{"--timeout", "5s", "stats"}, "stats.get"},
      {{"--timeout", "5s", "log", "level"}, "log.level"},
      {{"--timeout", "5s", "quarantine"}, "quarantine.list"}};
  for (const auto& [words, method] : looks) {
    const Scene scene(words, Json::object());

    ASSERT_EQ(scene.asked.size(), 1U) << method;
    EXPECT_EQ(scene.asked[0].method, method);
    EXPECT_EQ(scene.asked[0].params, Json::object());
  }
}

TEST(ChangingCommands, RefuseTheGuardsOfAChangeWhereTheyOnlyLook) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"stats", "--reason", "x"},
                                                {"log", "level", "--if-generation", "4"},
                                                {"quarantine", "--reason", "x"}}) {
    const Outcome outcome = run("/nowhere", words);
    EXPECT_EQ(outcome.exit, 2) << words.front();
    EXPECT_NE(outcome.err.find(words.front() + " changes nothing"), std::string::npos);
  }
}

TEST(SwapCore, PrintsTheReceiptAsOneLineOfJson) {
  const Scene scene({"--json", "swap-core", "control", "guidance/finite_time"}, kSwapReceipt);

  EXPECT_EQ(Json::parse(scene.outcome.out), kSwapReceipt);
  EXPECT_EQ(scene.outcome.out.find('\n'), scene.outcome.out.size() - 1);
  EXPECT_EQ(scene.asked[0].params.size(), 2U);
}

TEST(SwapCore, EndsWith9WhenTheRobotIsInItsSafeState) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto fault = protocol::fault_of(refuse(Errc::hook_failed, "control", "no"), "safe");
    peer.say(protocol::to_line(protocol::make_error(peer.hear().id, fault)) + "\n");
    peer.wait_for_the_end();
  });

  EXPECT_EQ(run(server.path(), {"swap-core", "control", "b/c"}).exit, 9);
}

TEST(Set, SendsJsonWhereItIsAndTextElse) {
  const Scene scene({"set", "a.x=1", "a.y=true", "a.z=10ms", "a.s=\"1\"", "a.v=[1,2]", "a.e="},
                    kSwapReceipt);

  EXPECT_EQ(scene.asked[0].params["values"],
            Json::parse(R"({"a.x":1,"a.y":true,"a.z":"10ms","a.s":"1","a.v":[1,2],"a.e":""})"));
}

TEST(Set, RefusesWhatIsNoAssignmentWithoutAsking) {
  const Outcome outcome = run("/nowhere", {"set", "a.x"});

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("'a.x' is not ADDRESS=VALUE"));
  EXPECT_THAT(run("/nowhere", {"swap-core", "a", "b/c", "--set", "x"}).err,
              testing::HasSubstr("'x' is not NAME=VALUE"));
  EXPECT_EQ(run("/nowhere", {"set", "a.x=1", "a.x=2"}).exit, 2);
}

TEST(Set, SaysHowToWriteWhatTheShellTookApart) {
  EXPECT_THAT(run("/nowhere", {"set", "m.core.goal=x:0", "m.core.goal=y:0"}).err,
              testing::HasSubstr("quote JSON for the shell: 'm.core.goal={...}'"));
  EXPECT_THAT(run("/nowhere", {"set", "a.x=1", "a.x=2"}).err,
              testing::Not(testing::HasSubstr("quote")));
}

TEST(Stop, WantsNamesOrAll) {
  const Outcome none = run("/nowhere", {"stop"});
  EXPECT_EQ(none.exit, 2);
  EXPECT_THAT(none.err, testing::HasSubstr("explain: mauvectl explain usage_components_or_all\n"));
  EXPECT_EQ(run("/nowhere", {"stop", "a", "--all"}).exit, 2);
  EXPECT_EQ(Scene({"stop", "--all"}, kSwapReceipt).asked[0].params, (Json{{"all", true}}));
  EXPECT_EQ(Scene({"stop", "a", "b"}, kSwapReceipt).asked[0].params,
            (Json{{"components", {"a", "b"}}}));
}

TEST(Get, PrintsOneLineForEachAddress) {
  const Scene scene({"--json", "get", "a.x", "b.y"},
                    {{"address", "a.x"}, {"value", 1}, {"status", "current"}});

  EXPECT_EQ(scene.asked.size(), 2U);
  EXPECT_EQ(scene.asked[1].params, (Json{{"address", "b.y"}}));
  const std::string line = R"({"address":"a.x","status":"current","value":1})"
                           "\n";
  EXPECT_EQ(scene.outcome.out, line + line);
}

TEST(Get, GoesOnBehindAnAddressThatIsRefused) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto first = peer.hear();
    const auto fault = protocol::fault_of(refuse(Errc::unknown_name, "a.x", "no such"));
    peer.say(protocol::to_line(protocol::make_error(first.id, fault)) + "\n");
    peer.answer(peer.hear(), {{"address", "b"}, {"value", 2}, {"status", "current"}});
    peer.wait_for_the_end();
  });

  const Outcome outcome = run(server.path(), {"get", "a.x", "b"});

  EXPECT_EQ(outcome.exit, 4);
  EXPECT_EQ(outcome.out, "b = 2\n");
  EXPECT_NE(outcome.err.find("no such"), std::string::npos);
}

TEST(Watch, PrintsEveryValueInTheSameFormUntilTheDaemonGoes) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.answer(peer.hear(), {{"sub", 5}});
    const auto notify = [&](const char* method, const char* params) {
      peer.say(protocol::to_line(protocol::make_notification(method, Json::parse(params))) + "\n");
    };
    notify("value",
           R"({"sub":5,"address":"fix.read","value":{"mode":3},"status":"new_data","t_ns":1})");
    notify("value", R"({"sub":6,"address":"other.read","value":1,"status":"new_data","t_ns":1})");
    notify("dropped", R"({"sub":5,"address":"fix.read","count":12})");
    notify("replaced", R"({"sub":5,"address":"fix.read"})");
  });

  const Outcome outcome = run(server.path(), {"--json", "watch", "fix.read"});

  EXPECT_EQ(outcome.exit, 7);
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(
      Json::parse(line),
      Json::parse(R"({"address":"fix.read","value":{"mode":3},"status":"new_data","t_ns":1})"));
  std::getline(lines, line);
  EXPECT_EQ(Json::parse(line),
            Json::parse(R"({"address":"fix.read","value":null,"status":"dropped","count":12})"));
  std::getline(lines, line);
  EXPECT_EQ(Json::parse(line),
            Json::parse(R"({"address":"fix.read","value":null,"status":"replaced"})"));
  std::getline(lines, line);
  EXPECT_EQ(Json::parse(line)["error"]["exit"], 7);
}

TEST(Logs, AskForWhatWasSaid) {
  const Scene scene(
      {"logs", "gnss", "--level", "warn", "-n", "5"},
      Json::parse(R"({"records":[{"t":"T","level":"warn","component":"gnss","text":"x"}]})"));

  EXPECT_EQ(scene.asked[0].params,
            Json::parse(R"({"component":"gnss","level":"warn","n":5,"follow":false})"));
  EXPECT_EQ(scene.outcome.out, "T  warn   gnss: x\n");
}

TEST(Quarantine, ReleasesACoreThatIsNamed) {
  const Scene scene({"quarantine", "release", "a/b"}, kSwapReceipt);

  EXPECT_EQ(scene.asked[0].method, "quarantine.release");
  EXPECT_EQ(scene.asked[0].params, (Json{{"core", "a/b"}}));
  EXPECT_EQ(run("/nowhere", {"quarantine", "release"}).exit, 2);
}

TEST(List, KnowsItsKinds) {
  EXPECT_EQ(Scene({"list"}, {{"items", Json::array()}}).asked[0].method, "component.list");
  EXPECT_EQ(Scene({"list", "ports"}, {{"items", Json::array()}}).asked[0].method, "port.list");
  EXPECT_EQ(Scene({"list", "core"}, {{"items", Json::array()}}).asked[0].method, "core.list");
  EXPECT_NE(run("/nowhere", {"list", "pots"}).err.find("did you mean 'ports'"), std::string::npos);
}

TEST(Plugins, MayBeAskedForOneComponent) {
  const Json none = {{"items", Json::array()}};
  EXPECT_EQ(Scene({"plugins"}, none).asked[0].params, Json::object());
  EXPECT_EQ(Scene({"plugins", "--for", "arm"}, none).asked[0].params, (Json{{"for", "arm"}}));
}

constexpr const char* kCheckedFile = MAUVE_ETC_DIR "/minimal.json";

TEST(Check, SaysHowToDoItWithoutTheDaemon) {
  const Outcome outcome = run("/nowhere", {"check", kCheckedFile});

  EXPECT_EQ(outcome.exit, 7);
  EXPECT_NE(outcome.err.find("mauved --check"), std::string::npos);
  EXPECT_NE(outcome.err.find("--plugin-dir DIR names a folder of plugins"), std::string::npos);
  EXPECT_NE(run("/nowhere", {"help", "check"}).out.find("--plugin-dir DIR"), std::string::npos);
}

TEST(Check, EndsWith1WhenThereAreErrors) {
  const Json errors =
      Json::parse(R"({"errors":[{"line":1,"column":2,"at":"","message":"no","hint":""}]})");

  const Scene bad({"check", kCheckedFile}, errors);
  const Scene good({"check", kCheckedFile}, {{"errors", Json::array()}});

  EXPECT_EQ(bad.outcome.exit, 1);
  EXPECT_EQ(good.outcome.exit, 0);
  EXPECT_EQ(bad.asked[0].params["file"], kCheckedFile);
}

TEST(Check, PrintsNotesOnAFileWithoutErrors) {
  const Scene good({"check", kCheckedFile},
                   {{"errors", Json::array()}, {"notes", {"rules.loud.do is refused"}}});

  EXPECT_EQ(good.outcome.exit, 0);
  EXPECT_NE(good.outcome.out.find(": no errors\nnote: rules.loud.do is refused\n"),
            std::string::npos);
}

TEST(Check, RefusesAFileThatCannotBeRead) {
  EXPECT_EQ(run("/nowhere", {"check", "/nowhere/x.json"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"check", "/tmp"}).exit, 2);
  const Outcome program = run("/nowhere", {"check", "/bin/true"});
  EXPECT_EQ(program.exit, 2);
  EXPECT_NE(program.err.find("this is no JSON file"), std::string::npos) << program.err;
}

TEST(Errors, AreJsonOnStandardOutputWhereAsked) {
  const Outcome outcome = run("/nowhere", {"--json", "status"});

  EXPECT_EQ(outcome.exit, 7);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(Json::parse(outcome.out)["error"]["name"], "unreachable");
}

TEST(Plugin, IsLoadedByName) {
  const Scene scene(
      {"load", "extra"},
      Json::parse(R"({"plugin":"extra","generation":43,"loaded":true,"unmapped":false,"why":""})"));

  EXPECT_EQ(scene.asked[0].method, "plugin.load");
  EXPECT_EQ(scene.outcome.out, "loaded extra (generation 43)\n");
}

TEST(History, AsksForAsManyAsWanted) {
  const Json nothing = {{"items", Json::array()}, {"state_dir", nullptr}};
  const Scene all({"history"}, nothing);
  const Scene some({"history", "-n", "3"}, nothing);

  EXPECT_EQ(all.asked.at(0).method, "config.history");
  EXPECT_EQ(all.asked.at(0).params, Json::object());
  EXPECT_EQ(some.asked.at(0).params, Json({{"n", 3}}));
  EXPECT_EQ(all.outcome.exit, 0);
}

TEST(Rollback, NamesAGeneration) {
  const Scene scene({"rollback", "41", "--reason", "it shook"}, kSwapReceipt);

  EXPECT_EQ(scene.asked.at(0).method, "config.rollback");
  EXPECT_EQ(scene.asked.at(0).params, Json({{"generation", 41}, {"reason", "it shook"}}));
  EXPECT_EQ(run("/nowhere", {"rollback", "yesterday"}).exit, 2);
}

TEST(Lock, SaysWhatIsLocked) {
  const Scene lock({"lock", "all"}, {{"lock", "all"}, {"changed", true}, {"generation", 4}});
  const Scene unlock({"lock", "none"}, {{"lock", "none"}, {"changed", true}, {"generation", 4}});

  EXPECT_EQ(lock.asked.at(0).params, Json({{"lock", "all"}}));
  EXPECT_EQ(lock.outcome.out, "locked all (generation 4)\n");
  EXPECT_EQ(unlock.outcome.out, "unlocked (generation 4)\n");
}

}  // namespace
}  // namespace mauve::ctl
