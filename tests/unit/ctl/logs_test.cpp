// SPDX-License-Identifier: LGPL-3.0-or-later
// Logs: what is asked for, what is missing, and the level.
#include <cstdlib>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "commands/log_time.h"
#include "mauve/log.h"
#include "mauve/result.h"
#include "render/render.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

using std::chrono::system_clock;
using testing::HasSubstr;
using testing::Not;

const Json kRecord = Json::parse(R"({"seq": 7, "t": "2026-01-01T10:00:00.000000Z", "t_ns": 1,
  "level": "warn", "component": "gnss", "event": "core_message", "text": "no fix", "fields": {}})");

system_clock::time_point moment() { return system_clock::from_time_t(1'767'261'600); }  // 10:00 UTC

TEST(LogTime, IsALengthBeforeNow) {
  EXPECT_EQ(since_when("10min", moment()), "2026-01-01T09:50:00Z");
  EXPECT_EQ(since_when("90s", moment()), "2026-01-01T09:58:30Z");
  EXPECT_EQ(since_when("1ms", moment()), "2026-01-01T09:59:59Z");
}

TEST(LogTime, OfTheClockIsTheLastOneHere) {
  setenv("TZ", "UTC-2", 1);  // two hours east: it is 12:00 there
  tzset();
  EXPECT_EQ(since_when("11:30", moment()), "2026-01-01T09:30:00Z");
  EXPECT_EQ(since_when("12:30", moment()), "2025-12-31T10:30:00Z") << "of yesterday";
  EXPECT_EQ(since_when("12:00:00", moment()), "2026-01-01T10:00:00Z");
  unsetenv("TZ");
  tzset();
}

TEST(LogTime, IsPassedOnWhenItIsWhole) {
  EXPECT_EQ(since_when("2026-01-31T12:00:00+02:00", moment()), "2026-01-31T12:00:00+02:00");
  for (const char* bad : {"", "10", "soon", "25:00", "12:60", "1:30", "12-30", "10m"}) {
    EXPECT_EQ(since_when(bad, moment()), std::nullopt) << bad;
  }
}

TEST(Logs, AskForATimeAndAText) {
  const Scene scene({"logs", "gnss", "--since", "2026-01-01", "--grep", "fix", "-n", "5"},
                    {{"records", {kRecord}}, {"dropped", {{"lost", 0}, {"gone", 0}}}});

  EXPECT_EQ(scene.asked[0].params, Json::parse(R"({"follow": false, "component": "gnss",
    "since": "2026-01-01", "grep": "fix", "n": 5})"));
  EXPECT_THAT(scene.outcome.out, HasSubstr("gnss: no fix"));
  EXPECT_EQ(scene.outcome.err, "") << "nothing is missing";
  EXPECT_EQ(run("/nowhere", {"logs", "--since", "soon"}).exit, 2);
}

TEST(Logs, SayAtTheEndWhatIsMissing) {
  const Json answer = {{"records", {kRecord}}, {"dropped", {{"lost", 12}, {"gone", 3}}}};

  const Scene people({"logs"}, answer);
  EXPECT_THAT(
      people.outcome.err,
      HasSubstr("events missing here: 12 were never recorded: too many were reported at once, "
                "3 older ones are not kept any more"));
  EXPECT_THAT(people.outcome.out, Not(HasSubstr("missing")));
  const Scene scripts({"--json", "logs"}, answer);
  EXPECT_EQ(scripts.outcome.err, "");
  EXPECT_THAT(scripts.outcome.out,
              HasSubstr("{\"event\":\"dropped\",\"gone\":3,\"lost\":12,\"slow\":0}\n"));
}

TEST(Logs, CountWhatASlowReaderLost) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.answer(peer.hear(), {{"records", Json::array()}, {"sub", 4}});
    Json record = kRecord;
    record["sub"] = 4;
    peer.say(protocol::to_line(protocol::make_notification("log", record)) + "\n");
    peer.say(protocol::to_line(protocol::make_notification(
                 "dropped", {{"sub", 4}, {"address", ""}, {"count", 9}})) +
             "\n");
  });

  const Outcome outcome = run(server.path(), {"logs", "-f"});

  EXPECT_THAT(outcome.out, HasSubstr("gnss: no fix"));
  EXPECT_THAT(outcome.out, HasSubstr("9 records dropped"));
  EXPECT_THAT(outcome.err, HasSubstr("9 were dropped: this reader was too slow"));
  EXPECT_EQ(outcome.exit, 7) << "the daemon went away";
}

TEST(LogLevel, IsSetForAComponentAndATime) {
  const Scene scene({"log", "level", "control=debug", "--for", "10min", "--reason", "look"},
                    {{"component", "control"}, {"level", "debug"}, {"for", "10min"}});

  EXPECT_EQ(scene.asked[0].method, "log.set_level");
  EXPECT_EQ(scene.asked[0].params, Json::parse(R"({"level": "debug", "component": "control",
    "for": "10min", "reason": "look"})"));
  EXPECT_EQ(scene.outcome.out, "log level of control is debug for 10min\n");
  const Scene all({"log", "level", "warn"},
                  {{"component", ""}, {"level", "warn"}, {"for", nullptr}});
  EXPECT_EQ(all.asked[0].params, (Json{{"level", "warn"}}));
  EXPECT_EQ(all.outcome.out, "log level of all is warn\n");
}

TEST(LogLevel, IsShownWithoutASetting) {
  const Json answer = Json::parse(R"({"level": "info", "default": "info", "items": [
    {"component": "control", "level": "debug", "left_s": 540}]})");
  const Scene scene({"log", "level"}, answer);

  EXPECT_EQ(scene.asked[0].method, "log.level");
  EXPECT_EQ(scene.outcome.out, "log level info, by default info\ncontrol: debug, 9 min still\n");
}

TEST(LogLevel, StandsInTheStatus) {
  const Json status = Json::parse(R"({"architecture": "rover", "generation": 1, "components": [],
    "log_levels": [{"component": "", "level": "debug", "left_s": 60}]})");

  EXPECT_THAT(render_status(status, {}), HasSubstr("log level debug for 1 min still"));
}

TEST(Explain, PrintsTheAdviceOfEveryMessageWithoutADaemon) {
  const Json all = Json::parse(run("/nowhere", {"--json", "explain"}).out)["items"];
  ASSERT_GT(all.size(), 60U);
  std::set<std::string> names;
  for (const Json& message : all) {
    const auto name = message["name"].get<std::string>();
    EXPECT_TRUE(names.insert(name).second) << name << " has two meanings";
    const Outcome outcome = run("/nowhere", {"explain", name});
    EXPECT_EQ(outcome.exit, 0) << name;
    EXPECT_THAT(outcome.out, HasSubstr(message["advice"].get<std::string>())) << name;
    EXPECT_EQ(run("/nowhere", {"logs", "--explain", name}).out, outcome.out) << name;
  }
  EXPECT_EQ(run("/nowhere", {"logs", "--explain"}).out, run("/nowhere", {"explain"}).out);
}

TEST(Explain, SaysOfEachRefusalWhatItMeansForTheRunningSystem) {
  const Json all = Json::parse(run("/nowhere", {"--json", "explain"}).out)["items"];
  int refusals = 0;
  for (const Json& message : all) {
    if (!message.contains("refusal")) continue;
    ++refusals;
    EXPECT_NE(message["system"], "") << message;
  }
  EXPECT_GT(refusals, 0);
  EXPECT_EQ(
      run("/nowhere", {"explain", "outcome_unknown"}).out,
      "outcome_unknown\n"
      "  kind   : refusal, timed_out\n"
      "  meaning: The time of the command (--timeout) ended while its change was taking effect.\n"
      "  system : The change may still take effect: `mauvectl history` shows whether it did.\n"
      "  advice : Do not send it again at once: mauvectl history shows whether it made a "
      "generation.\n");
}

TEST(Explain, LeavesOutATextThatIsOneValueOnly) {
  EXPECT_THAT(run("/nowhere", {"explain", "overrun"}).out,
              testing::StartsWith("overrun\n  kind   : event, warn\n  meaning: "));
  EXPECT_THAT(run("/nowhere", {"explain", "rolled_back"}).out, HasSubstr("  text   : "));
}

/// The names on the wire are those of mauve::Errc, which ends where to_string() knows no name.
TEST(Explain, KnowsEachReasonToRefuse) {
  std::vector<std::string> refusals;
  const Json all = Json::parse(run("/nowhere", {"--json", "explain"}).out)["items"];
  for (const Json& message : all) {
    if (message["kind"] == "refusal" && !message.contains("refusal")) {
      refusals.push_back(message["name"]);
    }
  }
  std::vector<std::string> names = {"unreachable",    "bad_answer",    "internal",
                                    "usage",          "parse_error",   "invalid_request",
                                    "unknown_method", "invalid_params"};
  for (int code = 0; to_string(static_cast<Errc>(code)) != "unknown"; ++code) {
    names.emplace_back(to_string(static_cast<Errc>(code)));
  }
  EXPECT_THAT(refusals, testing::UnorderedElementsAreArray(names));
}

TEST(Explain, NamesTheNearestMessageAndTheList) {
  const Outcome outcome = run("/nowhere", {"logs", "--explain", "rule_fierd"});

  EXPECT_EQ(outcome.exit, 4);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean 'rule_fired'?"));
  EXPECT_THAT(outcome.err, HasSubstr("mauvectl explain lists all messages"));
  EXPECT_THAT(outcome.err, HasSubstr("plugins cannot be looked up: no mauved answers at /nowhere"));
}

TEST(Explain, KnowsTheWordsBesideAValue) {
  for (const char* status : {"current", "no_data", "old_data", "new_data", "stale", "poisoned"}) {
    EXPECT_THAT(run("/nowhere", {"explain", status}).out, HasSubstr("  kind   : status\n"));
  }
}

TEST(Explain, SaysWhichPluginBringsAName) {
  const Json plugins = Json::parse(R"({"items": [{"name": "guidance", "version": "1.2",
    "file": "/p/guidance.so", "cores": ["guidance/stop", "guidance/mission"],
    "components": ["guidance/mission"], "fsms": ["guidance/mission"], "types": ["gain/1"]}]})");
  const Scene core({"explain", "guidance/stop"}, plugins);
  const Scene plugin({"explain", "guidance"}, plugins);
  const Scene unknown({"explain", "gain/2"}, plugins);

  EXPECT_EQ(core.outcome.exit, 0);
  EXPECT_THAT(core.outcome.out, HasSubstr("is     : a core of plugin guidance 1.2"));
  EXPECT_THAT(plugin.outcome.out, HasSubstr("is     : a plugin, version 1.2"));
  EXPECT_THAT(plugin.outcome.out, HasSubstr("  cores  : guidance/stop, guidance/mission\n"));
  EXPECT_THAT(unknown.outcome.err, HasSubstr("did you mean 'gain/1'?"));
  EXPECT_THAT(Scene({"explain", "guidance/mission"}, plugins).outcome.out,
              HasSubstr("a core and a state machine and a component of plugin guidance 1.2"));
}

}  // namespace
}  // namespace mauve::ctl
