// SPDX-License-Identifier: LGPL-3.0-or-later
// Traces and flight recordings of a running daemon.
#include <filesystem>
#include <sstream>
#include <thread>

#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// All records of a file or of the wire, by event.
std::size_t count(const std::vector<Json>& records, const std::string& event,
                  const std::string& thread = "") {
  return static_cast<std::size_t>(
      std::count_if(records.begin(), records.end(), [&](const Json& record) {
        return record[2] == event && (thread.empty() || record[1] == thread);
      }));
}

struct TraceFile {
  Json header;
  std::vector<Json> records;
  Json end;
};

TraceFile read_trace(const std::filesystem::path& file) {
  TraceFile trace;
  std::istringstream text(TempDir::read(file));
  for (std::string line; std::getline(text, line);) {
    auto json = Json::parse(line);
    if (json.is_array()) {
      trace.records.push_back(std::move(json));
    } else {
      (trace.header.is_null() ? trace.header : trace.end) = std::move(json);
    }
  }
  return trace;
}

/// All pages of the trace that is on, or else was last; a slow machine makes it long.
TraceFile whole_trace(TrialDaemon& daemon) {
  TraceFile trace;
  Json page = daemon.ask("trace.read");
  trace.header = page["header"];
  while (true) {
    trace.records.insert(trace.records.end(), page["records"].begin(), page["records"].end());
    if (page["end"] == true || !page.contains("next")) return trace;
    page = daemon.ask("trace.read", {{"recording", page["recording"]}, {"from", page["next"]}});
  }
}

/// No release of it is ever missed, however busy the machine is.
std::string calm() {
  auto architecture = Json::parse(std::string(kTrial));
  for (auto& component : architecture["components"]) {
    component["task"] = {{"on_overrun", "catch_up"}};
  }
  return architecture.dump();
}

class Traces : public Generations {
 protected:
  /// Waits for a flight recording, and gives it.
  [[nodiscard]] TraceFile flight(const std::string& name) const {
    const auto file = state() / (name + ".mtrace");
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(file); })) << name;
    return read_trace(file);
  }
};

TEST_F(Traces, AreTheLastSecondsWithoutBeingAskedFor) {
  TrialDaemon daemon(calm(), options());
  ASSERT_TRUE(eventually([&] { return daemon.ask("trace.status")["records"] > 100; }));

  const auto file = place_ / "now.mtrace";
  ASSERT_EQ(daemon.ctl({"trace", "dump", "-o", file.string()}).exit, 0);

  const auto trace = read_trace(file);
  EXPECT_EQ(trace.header["architecture"], "trial");
  EXPECT_EQ(trace.header["mauve_trace"], 1);
  EXPECT_EQ(trace.header["components"].size(), 2U) << trace.header;
  EXPECT_EQ(trace.end["records"], trace.records.size());
  EXPECT_GT(count(trace.records, "release", "first"), 5U);
  EXPECT_EQ(count(trace.records, "call"), 0U) << "only in detail";
  Json before = trace.records.front()[0];
  for (const auto& record : trace.records) {
    ASSERT_GE(record[0], before) << "by time";
    before = record[0];
  }
}

TEST_F(Traces, BeginAndEndAndRecordAChangeInBetween) {
  TrialDaemon daemon(calm(), options());
  EXPECT_EQ(daemon.ask("trace.stop")["data"]["name"], "wrong_state");

  ASSERT_EQ(daemon.ask("trace.start", {{"detail", true}})["on"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["state"], "applied");
  ASSERT_TRUE(eventually([&] { return count(whole_trace(daemon).records, "call", "first") > 0; }));
  const auto stopped = daemon.ask("trace.stop");
  EXPECT_EQ(stopped["on"], false) << stopped;

  const auto trace = whole_trace(daemon);
  const auto& records = trace.records;
  EXPECT_EQ(count(records, "commit"), 1U);
  EXPECT_EQ(count(records, "applied", "first"), 1U);
  EXPECT_EQ(count(records, "set", "[control]"), 1U);
  EXPECT_GT(count(records, "call", "first"), 0U);
  EXPECT_EQ(whole_trace(daemon).records, records) << "the trace is over";
  EXPECT_TRUE(eventually([&] {
    const auto now = daemon.ask("trace.read", {{"now", true}});
    return now["header"]["to"] > trace.header["to"] && !now["records"].empty();
  })) << "the flight recorder goes on";
}

TEST_F(Traces, ComeInPagesThatBelongTogether) {
  TrialDaemon daemon(calm(), options());
  ASSERT_TRUE(eventually([&] { return daemon.ask("trace.status")["records"] > 200; }));

  const auto first = daemon.ask("trace.read", {{"count", 100}});
  ASSERT_EQ(first["records"].size(), 100U);
  const Json next = {{"recording", first["recording"]}, {"from", first["next"]}, {"count", 50}};
  const auto second = daemon.ask("trace.read", next);

  EXPECT_EQ(second["records"].size(), 50U);
  EXPECT_EQ(second["next"], 150);
  EXPECT_EQ(second["header"]["to"], first["header"]["to"]) << "of the same moment";
  EXPECT_EQ(daemon.ask("trace.read", {{"recording", "snapshot-99"}})["data"]["name"],
            "unknown_name");
}

TEST_F(Traces, RefuseWhatHasNoMeaning) {
  TrialDaemon daemon(calm(), options());

  for (const int seconds : {0, 601, 1'000'000'000}) {
    const auto refused = daemon.ask("trace.start", {{"seconds", seconds}});
    EXPECT_EQ(refused["data"]["where"], "seconds") << seconds << refused;
  }
  EXPECT_EQ(daemon.ask("trace.start", {{"seconds", -1}})["data"]["name"], "invalid_params");
  EXPECT_EQ(daemon.ask("trace.read", {{"from", -1}})["data"]["name"], "invalid_params");
  EXPECT_EQ(daemon.ask("trace.read", {{"recording", "flight-../../audit"}})["data"]["name"],
            "unknown_name");
  EXPECT_NE(daemon.ctl({"trace", "dump"}).exit, 0) << "into which file";
  EXPECT_NE(daemon.ctl({"trace", "dump", "-o", "/proc/none/x.mtrace"}).exit, 0);
  EXPECT_NE(daemon.ctl({"trace", "nonsense"}).exit, 0);
}

TEST_F(Traces, AFaultIsRecordedWithTheSecondsBefore) {
  TrialDaemon daemon(calm(), options());
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");

  const auto trace = flight("flight-0001-fault-first");

  EXPECT_EQ(trace.header["why"], "fault first");
  ASSERT_EQ(count(trace.records, "fault", "first"), 1U);
  EXPECT_GT(count(trace.records, "release", "first"), 0U) << "before it";
  EXPECT_EQ(count(trace.records, "commit", "[control]"), 1U);
  EXPECT_EQ(trace.end["end"], true);
  ASSERT_TRUE(was_logged(daemon, "flight_recorded"));
  const auto list = daemon.ask("trace.list")["items"];
  ASSERT_EQ(list.size(), 1U) << list;
  EXPECT_EQ(list[0]["name"], "flight-0001-fault-first");
  EXPECT_EQ(list[0]["records"], trace.records.size());
  const auto table = daemon.ctl({"trace", "list"}).out;
  EXPECT_EQ(table.find("NAME"), 0U) << table;
  EXPECT_NE(table.find("fault first"), std::string::npos) << table;
  const auto copy = place_ / "copy.mtrace";
  ASSERT_EQ(daemon.ctl({"trace", "dump", "flight-0001-fault-first", "-o", copy.string()}).exit, 0);
  EXPECT_EQ(read_trace(copy).records, trace.records);
}

TEST_F(Traces, AFaultRightAfterAMissIsRecorded) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_TRUE(eventually([&] {
    daemon.process().signal(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // some of its releases
    daemon.process().signal(SIGCONT);
    return !daemon.ask("trace.list")["items"].empty();
  }));
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");

  EXPECT_TRUE(eventually([&] {
    return daemon.ask("trace.list").dump().find("-fault-first") != std::string::npos;
  })) << daemon.ask("trace.list");
}

TEST_F(Traces, TheFourthFaultInThirtySecondsIsNotRecordedAndTheLogSaysSo) {
  TrialDaemon daemon(calm(), options());
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  for (const char* name : {"flight-0001-fault-first", "flight-0002-fault-first"}) {
    static_cast<void>(flight(name));
    ASSERT_EQ(daemon.ask("component.start", {{"components", {"first"}}})["state"], "applied");
  }
  static_cast<void>(flight("flight-0003-fault-first"));
  ASSERT_EQ(daemon.ask("component.start", {{"components", {"first"}}})["state"], "applied");

  EXPECT_TRUE(was_logged(daemon, "flight_skipped"));
  EXPECT_EQ(daemon.ask("trace.list")["items"].size(), 3U);
}

TEST_F(Traces, AMissedReleaseIsRecorded) {
  TrialDaemon daemon(kTrial, options());

  ASSERT_TRUE(eventually([&] {
    daemon.process().signal(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // some of its releases
    daemon.process().signal(SIGCONT);
    return !daemon.ask("trace.list")["items"].empty();
  }));

  const auto list = daemon.ask("trace.list")["items"];
  EXPECT_THAT(list[0]["name"].get<std::string>(), HasSubstr("missed"));
}

TEST_F(Traces, ARollbackIsRecorded) {
  TrialDaemon daemon(calm(), options());
  const Json swap = {{"component", "first"}, {"core", "trial/other"}, {"misses", "63/64"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  const auto trace = flight("flight-0001-rollback-first");
  EXPECT_EQ(count(trace.records, "rollback", "[control]"), 1U);
  EXPECT_EQ(count(trace.records, "applied", "first"), 2U) << "forth and back";
}

TEST_F(Traces, WithoutTheFlightRecorderNothingIsTracedUntilSomebodyAsks) {
  TrialDaemon daemon(calm(), {"--realtime", "off", "--flight-recorder", "off"});

  EXPECT_EQ(daemon.ask("trace.read")["data"]["name"], "wrong_state");
  const auto status = daemon.ask("trace.status");
  EXPECT_EQ(status["flight_recorder"], false);
  EXPECT_EQ(status["bytes"], 0) << "no memory is allocated for nothing";

  ASSERT_EQ(daemon.ask("trace.start")["on"], true);
  EXPECT_TRUE(eventually([&] { return daemon.ask("trace.read")["records"].size() > 20; }));
}

TEST_F(Traces, AnUnwritableStateDirectoryIsReportedAndHarmsNothing) {
  TrialDaemon daemon(calm(), options());
  ASSERT_TRUE(eventually([&] { return daemon.ask("trace.status")["records"] > 0; }));
  std::filesystem::rename(state(), place_ / "elsewhere");
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");

  EXPECT_TRUE(was_logged(daemon, "flight_not_kept"));
  EXPECT_TRUE(daemon.ask("trace.list")["items"].empty());
  EXPECT_EQ(daemon.component("second")["state"], "running");
}

}  // namespace
}  // namespace mauve::test
