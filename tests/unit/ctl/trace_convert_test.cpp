// SPDX-License-Identifier: LGPL-3.0-or-later
// Traces for other tools: Perfetto's JSON, and the bytes of CTF (Trace.ctf reads them with
// babeltrace2).
#include "mtrace/convert.h"

#include <unistd.h>

#include <filesystem>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "mtrace/chrome.h"
#include "mtrace/ctf.h"
#include "protocol/framing.h"
#include "unit/ctl/made_trace.h"

namespace mauve::ctl::mtrace {
namespace {

using protocol::Json;
using testing::HasSubstr;

Trace made() { return MadeTrace(2).make(4, 50'000'000, 3, 50); }

Json chrome(const Trace& trace) {
  std::ostringstream out;
  write_chrome(trace, out);
  auto json = protocol::parse_json(out.str());
  if (!json) ADD_FAILURE() << to_string(json.error());
  return json ? *json : Json::object();
}

std::size_t count_of(const Trace& trace, Event event) {
  return static_cast<std::size_t>(
      std::count_if(trace.records.begin(), trace.records.end(),
                    [&](const Record& one) { return one.event == event; }));
}

std::size_t count_of(const Json& file, const char* key, const std::string& value) {
  std::size_t count = 0;
  for (const Json& one : file["traceEvents"]) count += one.value(key, "") == value ? 1 : 0;
  return count;
}

TEST(Chrome, HasASliceForEachJobAndEachStateInIt) {
  const Trace trace = made();
  const Json file = chrome(trace);

  EXPECT_EQ(count_of(file, "cat", "job"), count_of(trace, Event::release));
  EXPECT_EQ(count_of(file, "cat", "state"), count_of(trace, Event::begin));
  EXPECT_EQ(count_of(file, "name", "hold world"), count_of(trace, Event::lock));
}

TEST(Chrome, SlicesOfAThreadLieWithinEachOther) {
  const Json file = chrome(made());
  std::map<int, std::vector<std::pair<double, double>>> jobs;
  for (const Json& one : file["traceEvents"]) {
    if (one.value("cat", "") != "job") continue;
    jobs[one["tid"]].emplace_back(one["ts"], one["ts"].get<double>() + one["dur"].get<double>());
  }
  ASSERT_GT(count_of(file, "cat", "state"), 0U);
  for (const Json& one : file["traceEvents"]) {
    if (one.value("cat", "") != "state") continue;
    const double from = one["ts"];
    const double to = from + one["dur"].get<double>();
    const auto& its = jobs[one["tid"]];
    EXPECT_TRUE(std::any_of(its.begin(), its.end(), [&](const auto& job) {
      return job.first <= from + 1e-6 && to <= job.second + 1e-6;
    })) << one.dump();
  }
}

TEST(Chrome, NamesThreadsInTheOrderOfPriority) {
  const Json file = chrome(made());
  std::vector<std::string> names;
  for (const Json& one : file["traceEvents"]) {
    if (one["name"] == "thread_name") names.push_back(one["args"]["name"]);
  }
  EXPECT_THAT(names, testing::ElementsAre("c0", "c1", "c2", "c3", "[control]"));
  EXPECT_EQ(count_of(file, "name", "process_name"), 1U);
}

TEST(Chrome, DrawsAnArrowFromEachChangeToWhoTookIt) {
  const Trace trace = made();
  const Json file = chrome(trace);

  EXPECT_GT(count_of(trace, Event::applied), 2U);
  EXPECT_EQ(count_of(file, "ph", "s"), count_of(trace, Event::applied));
  EXPECT_EQ(count_of(file, "ph", "f"), count_of(trace, Event::applied));
}

TEST(Chrome, HasTimesInMicrosecondsWithTheirNanoseconds) {
  Trace trace;
  Record record;
  record.event = Event::user;
  record.thread = trace.intern("a\"b");
  record.name = trace.intern("gain");
  for (const std::int64_t time : {-1'234'567LL, -1LL, 1'000'000'000'123'456'789LL}) {
    record.time = time;
    record.b = std::bit_cast<std::int64_t>(0.5);
    trace.records.push_back(record);
  }
  record.b = std::bit_cast<std::int64_t>(std::numeric_limits<double>::quiet_NaN());
  trace.records.push_back(record);  // JSON has no word for it
  std::ostringstream out;
  write_chrome(trace, out);

  EXPECT_THAT(out.str(), HasSubstr(R"("ts":-1234.567,"name":"a\"b.gain")"));
  EXPECT_THAT(out.str(), HasSubstr(R"("ts":-0.001,)"));
  EXPECT_THAT(out.str(), HasSubstr(R"("ts":1000000000123456.789,)"));
  EXPECT_EQ(count_of(chrome(trace), "ph", "C"), 3U);
}

TEST(Chrome, OfNothingIsAFile) { EXPECT_EQ(chrome(Trace())["traceEvents"].size(), 1U); }

TEST(Ctf, DescribesEveryEvent) {
  const std::string metadata = ctf_metadata(made());

  EXPECT_THAT(metadata, testing::StartsWith("/* CTF 1.8 */"));
  for (std::size_t i = 0; i < event_words().size(); ++i) {
    const std::string event(to_string(static_cast<Event>(i)));
    EXPECT_THAT(metadata, HasSubstr("name = \"" + event + "\""));
  }
}

TEST(Ctf, CannotBeBrokenOutOfByNames) {
  Trace trace;
  trace.header.architecture = "a\"; b \\\n";

  EXPECT_THAT(ctf_metadata(trace), HasSubstr(R"(architecture = "a\"; b \\";)"));
}

TEST(Ctf, IsOnePacketOfTheSizeItSays) {
  const std::string stream = ctf_stream(made());
  std::uint64_t size = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    size |= static_cast<std::uint64_t>(static_cast<unsigned char>(stream[24 + i])) << (8 * i);
  }
  EXPECT_EQ(size, stream.size() * 8);
}

TEST(Convert, ChoosesTheFormatByTheEndOfTheName) {
  EXPECT_EQ(format_of("a.mtrace"), Format::mtrace);
  EXPECT_EQ(format_of("a.json"), Format::chrome);
  EXPECT_EQ(format_of("a"), Format::ctf);
}

TEST(Convert, SaysInTheWordsOfTheSystemThatItCannotWrite) {
  for (const Format format : {Format::mtrace, Format::chrome}) {
    const Status done = convert(made(), format, "/no/such/folder/x");
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().at, "/no/such/folder/x");
    EXPECT_THAT(done.error().message, HasSubstr("No such file or directory"));
  }
  EXPECT_FALSE(convert(made(), Format::ctf, "/proc/no/such"));
  EXPECT_THAT(convert(made(), Format::chrome, "/dev/full").error().message,
              HasSubstr("No space left"));
}

}  // namespace
}  // namespace mauve::ctl::mtrace
