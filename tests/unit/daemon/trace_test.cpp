// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <sstream>

#include "protocol/trace.h"
#include "support/temp_dir.h"
#include "trace/allowance.h"
#include "trace/file.h"
#include "trace/flights.h"
#include "trace/memory.h"
#include "trace/probe.h"

namespace mauve::daemon {
namespace {

using protocol::Json;
using test::TempDir;
using testing::ElementsAre;
using testing::HasSubstr;

TraceRecord record(Instant time, TraceKind kind = TraceKind::release, std::int64_t a = 0,
                   std::int64_t b = 0) {
  return {time, kind, trace_name_id("control"), 0, a, b};
}

std::vector<Instant> times(const Recording& recording) {
  std::vector<Instant> all;
  for (const auto& one : recording.records) {
    all.push_back(one.time);
  }
  return all;
}

TEST(TraceMemory, KeepsTheNewest) {
  TraceMemory memory(3);
  for (const Instant time : {1, 2, 3, 4, 5}) {
    memory.add(record(time));
  }
  EXPECT_THAT(times(memory.since(0)), ElementsAre(3, 4, 5));
  EXPECT_THAT(times(memory.since(5)), ElementsAre(5));
  EXPECT_EQ(memory.since(0).from, 3) << "nothing is known of before";
  EXPECT_EQ(memory.since(0).to, 5);
}

TEST(TraceMemory, TakesMemoryWithTheFirstRecord) {
  TraceMemory memory(10);
  EXPECT_EQ(memory.bytes(), 0U);
  EXPECT_THAT(times(memory.since(0)), ElementsAre());

  memory.add(record(1));

  EXPECT_EQ(memory.bytes(), 10 * sizeof(TraceRecord));
}

TEST(TraceMemory, SortsByTimeAndLeavesWhatIsEqualInItsOrder) {
  TraceMemory memory(10);
  memory.add(record(7, TraceKind::begin));
  memory.add(record(7, TraceKind::end));
  memory.add(record(3));

  const Recording recording = memory.since(0);

  EXPECT_THAT(times(recording), ElementsAre(3, 7, 7));
  EXPECT_EQ(recording.records[1].kind, TraceKind::begin);
}

TEST(TraceMemory, CountsWhatWasLostInItsTime) {
  TraceMemory memory(10);
  memory.add(record(1, TraceKind::lost, 5));
  memory.add(record(8, TraceKind::lost, 7));

  EXPECT_EQ(memory.since(0).lost, 12);
  EXPECT_EQ(memory.since(2).lost, 7);
}

TEST(TraceFile, LeavesOutWhatIsNothing) {
  EXPECT_EQ(to_json(record(5, TraceKind::stopped)).dump(), R"([5,"control","stopped"])");
  EXPECT_EQ(to_json(record(5, TraceKind::release, 4, 0)).dump(), R"([5,"control","release","",4])");
  EXPECT_EQ(to_json(record(5, TraceKind::release, 0, 3)).dump(),
            R"([5,"control","release","",0,3])");
}

Recording example(std::size_t records) {
  Recording recording;
  recording.about.architecture = "rover";
  recording.about.t0 = 12345;
  TracedComponent control;
  control.name = "control";
  control.period = 10ms;
  control.states = {{"guide", false, Duration{0}}, {"period", true, 10ms}};
  control.initial = "guide";
  recording.about.components = {control};
  recording.about.resources = {"world"};
  recording.why = "missed control";
  for (std::size_t i = 0; i < records; ++i) {
    recording.records.push_back(record(static_cast<Instant>(i) + 1));
  }
  return recording;
}

TEST(TraceFile, BeginsWithWhatItIsAboutAndEndsWithHowMuchItWas) {
  const Recording recording = example(2);
  std::istringstream text(to_text(recording, header_of(recording, "boot")));
  std::string header;
  std::getline(text, header);
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(text, line)) {
    lines.push_back(line);
  }

  const Json about = Json::parse(header);
  EXPECT_EQ(about["mauve_trace"], 1);
  EXPECT_EQ(about["t0_ns"], 12345);
  EXPECT_EQ(about["why"], "missed control");
  EXPECT_EQ(about["components"][0]["period_ns"], 10'000'000);
  EXPECT_EQ(about["components"][0]["states"][1]["kind"], "synchronization");
  EXPECT_FALSE(about["components"][0].contains("bound_ns")) << "none is known";
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], R"([1,"control","release"])");
  EXPECT_EQ(Json::parse(lines[2]), (Json{{"end", true}, {"records", 2}, {"lost", 0}}));
}

TEST(TraceFile, ComesInPages) {
  const Recording recording = example(12'000);

  const Json first = page_of(recording, 0, 1'000'000);
  EXPECT_EQ(first["records"].size(), protocol::kMostRecords);
  EXPECT_EQ(first["end"], false);
  const Json last = page_of(recording, 10'000, protocol::kMostRecords);
  EXPECT_EQ(last["records"].size(), 2000U);
  EXPECT_EQ(last["end"], true);
  EXPECT_EQ(page_of(recording, 99'999, 10)["records"].size(), 0U) << "behind its end";
  EXPECT_LT(protocol::to_line(first).size(), protocol::kMaxLine);
}

TEST(Probe, IsRefusedWhereItCannotRun) {
  Probe probe(CPU_SETSIZE - 1);

  EXPECT_FALSE(probe.start());
}

class FlightsTest : public testing::Test {
 protected:
  FlightsTest() { log_.start(); }
  void write(Flights& flights, const std::string& component = "control",
             const std::string& word = "missed") {
    auto recording = example(3);
    recording.why = word + " control";
    flights.write(recording, word, component, "boot");
  }
  [[nodiscard]] std::size_t events_of(logging::Event event) {
    log_.flush();
    std::size_t count = 0;
    for (const auto& one : log_.history().tail(1000, {})) {
      count += one.event == event ? 1U : 0U;
    }
    return count;
  }

  TempDir place_;
  logging::Log log_{logging::Level::debug};
};

TEST_F(FlightsTest, AreFilesWithTheirReasonInTheName) {
  Flights flights(place_.path().string(), log_);
  write(flights);

  ASSERT_EQ(flights.list().size(), 1U);
  EXPECT_EQ(flights.list()[0].name, "flight-0001-missed-control");
  EXPECT_EQ(flights.list()[0].why, "missed control");
  EXPECT_EQ(flights.list()[0].records, 3U);
  const auto file = flights.find("flight-0001-missed-control");
  ASSERT_TRUE(file);
  const auto page = page_of(*file, 0, 10);
  ASSERT_TRUE(page);
  EXPECT_EQ((*page)["records"].size(), 3U);
  EXPECT_EQ((*page)["end"], true);
  EXPECT_EQ((*page)["header"]["architecture"], "rover");
  EXPECT_EQ(events_of(logging::Event::flight_recorded), 1U);
}

TEST_F(FlightsTest, ComeInPagesThatGoOnWhereTheLastOneEnded) {
  Flights flights(place_.path().string(), log_);
  write(flights);
  const auto file = flights.find("flight-0001-missed-control");
  ASSERT_TRUE(file);

  const auto first = page_of(*file, 0, 2);
  ASSERT_TRUE(first);
  EXPECT_EQ((*first)["records"].size(), 2U);
  EXPECT_EQ((*first)["end"], false);
  const auto last = page_of(*file, (*first)["next"].get<std::size_t>(), 2);
  ASSERT_TRUE(last);
  ASSERT_EQ((*last)["records"].size(), 1U);
  EXPECT_EQ((*last)["records"][0][0], 3);
  EXPECT_EQ((*last)["end"], true);
  EXPECT_EQ((*last)["header"], (*first)["header"]);
  for (const std::size_t behind :
       {std::size_t{1'000'000}, std::numeric_limits<std::size_t>::max()}) {
    const auto none = page_of(*file, behind, 2);
    ASSERT_TRUE(none) << behind;
    EXPECT_EQ((*none)["records"].size(), 0U) << behind;
    EXPECT_EQ((*none)["end"], true) << behind;
  }
}

TEST_F(FlightsTest, OfEarlierRunsAreFoundAndNumbersGoOn) {
  {
    Flights flights(place_.path().string(), log_);
    write(flights);
  }
  Flights flights(place_.path().string(), log_);
  ASSERT_EQ(flights.list().size(), 1U);
  EXPECT_EQ(flights.list()[0].why, "missed control");
  EXPECT_EQ(flights.list()[0].records, 3U);
  write(flights, "");

  EXPECT_EQ(flights.list()[1].name, "flight-0002-missed");
}

TEST_F(FlightsTest, AreNoOtherFilesWhateverTheirContent) {
  {
    Flights flights(place_.path().string(), log_);
    write(flights);
  }
  for (const auto& entry : std::filesystem::directory_iterator(place_.path())) {
    const auto extension = entry.path().extension().string();
    for (const std::string name : {"copy", "flight-copy", "flight-1000000000000-far"}) {
      std::filesystem::copy_file(entry.path(), place_ / (name + extension));
    }
    break;
  }

  const Flights flights(place_.path().string(), log_);

  EXPECT_EQ(flights.list().size(), 1U);
}

TEST_F(FlightsTest, AreAtMostTwenty) {
  Flights flights(place_.path().string(), log_);
  for (std::size_t i = 0; i < Flights::kKept + 3; ++i) {
    write(flights);
  }
  EXPECT_EQ(flights.list().size(), Flights::kKept);
  EXPECT_EQ(flights.list().front().number, 4U) << "the oldest went";
  const std::filesystem::directory_iterator files(place_.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), static_cast<int>(Flights::kKept));
}

TEST_F(FlightsTest, OfMissesDoNotPushThoseOfFaultsOut) {
  Flights flights(place_.path().string(), log_);
  write(flights, "control", "fault");
  write(flights, "control", "rollback");
  for (std::size_t i = 0; i < 2 * Flights::kKept; ++i) {
    write(flights);
  }
  EXPECT_EQ(flights.list().size(), Flights::kKept);
  EXPECT_EQ(flights.list()[0].name, "flight-0001-fault-control");
  EXPECT_EQ(flights.list()[1].name, "flight-0002-rollback-control");

  for (std::size_t i = 0; i < 2 * Flights::kKept; ++i) {
    write(flights, "control", "fault");
  }
  const auto kept = flights.list();
  EXPECT_EQ(kept.size(), Flights::kKept);
  EXPECT_EQ(std::count_if(kept.begin(), kept.end(),
                          [](const Flight& one) { return one.why == "missed control"; }),
            static_cast<std::ptrdiff_t>(Flights::kKeptOfMisses))
      << "nor do faults push the last of misses out";
}

TEST(FlightAllowance, IsUsedUpUntilItsSpanHasPassed) {
  using std::chrono::seconds;
  FlightAllowance allowance(2, seconds(10));
  const FlightAllowance::Time begin{};

  EXPECT_TRUE(allowance.take(begin));
  EXPECT_TRUE(allowance.take(begin + seconds(4)));
  EXPECT_FALSE(allowance.take(begin + seconds(9)));
  EXPECT_TRUE(allowance.take(begin + seconds(10)));
  EXPECT_FALSE(allowance.take(begin + seconds(13))) << "two in any ten seconds";
  EXPECT_TRUE(allowance.take(begin + seconds(14)));
}

TEST_F(FlightsTest, AWriteThatFailsIsReportedOnce) {
  const auto missing = place_ / "missing";
  Flights flights(missing.string(), log_);
  write(flights);
  write(flights);
  EXPECT_TRUE(flights.list().empty());
  EXPECT_EQ(events_of(logging::Event::flight_not_kept), 1U);

  std::filesystem::create_directory(missing);
  write(flights);
  EXPECT_EQ(flights.list().size(), 1U) << "it works again";
}

TEST_F(FlightsTest, NothingElseCanBeReadByName) {
  Flights flights(place_.path().string(), log_);
  place_.write("secret", "x");

  for (const char* name : {"../secret", "secret", "flight-0001-missed-control", "flight-../x"}) {
    EXPECT_FALSE(flights.find(name)) << name;
  }
}

}  // namespace
}  // namespace mauve::daemon
