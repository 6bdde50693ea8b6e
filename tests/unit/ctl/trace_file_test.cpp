// SPDX-License-Identifier: LGPL-3.0-or-later
// Trace files: what is sound is read, what is not is counted, nothing is invented.
#include "mtrace/file.h"

#include <cmath>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "unit/ctl/made_trace.h"

namespace mauve::ctl::mtrace {
namespace {

using testing::HasSubstr;

const std::string kHeader = R"({"mauve_trace":1,"architecture":"rover","t0_ns":500,"from":0,)"
                            R"("to":100,"why":"missed control","components":[{"name":"control",)"
                            R"("priority":40,"cpus":[1],"realtime":true,"period_ns":10,)"
                            R"("bound_ns":7,"states":[{"name":"guide","kind":"execution"},)"
                            R"({"name":"pace","kind":"synchronization","wait_ns":10}]}]})"
                            "\n";
const std::string kRelease = "[3,\"control\",\"release\",\"\",2,1]\n";
const std::string kEnd = "{\"end\":true,\"records\":1,\"lost\":0}\n";

Result<Trace> parsed(const std::string& text, std::size_t piece = 1000) {
  Reader reader;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    reader.feed(std::string_view(text).substr(at, piece));
  }
  return reader.finish();
}

Trace read(const std::string& text) {
  auto trace = parsed(text);
  if (!trace) ADD_FAILURE() << to_string(trace.error());
  return trace ? std::move(*trace) : Trace{};
}

TEST(TraceFile, IsReadInPiecesOfAnySize) {
  for (const std::size_t piece : {1U, 2U, 7U, 100'000U}) {
    const auto trace = parsed(kHeader + kRelease + kEnd, piece);
    ASSERT_TRUE(trace);
    EXPECT_TRUE(trace->reading.complete);
    ASSERT_EQ(trace->records.size(), 1U);
    EXPECT_EQ(trace->records[0].time, 3);
    EXPECT_EQ(trace->records[0].a, 2);
    EXPECT_EQ(trace->records[0].b, 1);
    EXPECT_EQ(trace->records[0].line, 2U);
    const Component* control = trace->component(trace->records[0].thread);
    ASSERT_NE(control, nullptr);
    EXPECT_EQ(control->bound, 7);
    EXPECT_EQ(control->state("pace")->wait, 10);
  }
}

TEST(TraceFile, OfAnotherVersionIsRefusedWithBothNumbers) {
  const auto trace = parsed("{\"mauve_trace\":2}\n" + kRelease);

  ASSERT_FALSE(trace);
  EXPECT_THAT(trace.error().message, HasSubstr("version 2"));
  EXPECT_THAT(trace.error().message, HasSubstr("version 1"));
}

TEST(TraceFile, ThatIsNoneIsRefused) {
  for (const char* text :
       {"", "\n", "[]\n", "{}\n", "hello\n", "{\"mauve_trace\":\"1\"}", "\xff"}) {
    const auto trace = parsed(text);
    ASSERT_FALSE(trace) << text;
    EXPECT_THAT(trace.error().message, HasSubstr("no trace of mauve")) << text;
  }
}

TEST(TraceFile, ThatWasCutOffIsReadAsFarAsItGoes) {
  const std::string whole = kHeader + kRelease + kRelease;
  const Trace trace = read(whole.substr(0, whole.size() - 5));

  EXPECT_EQ(trace.records.size(), 1U);
  EXPECT_FALSE(trace.reading.complete);
  EXPECT_EQ(trace.reading.broken, 0U) << "being cut off is reported once";
}

TEST(TraceFile, CountsLinesThatAreNoRecordAndNamesTheFirst) {
  const Trace trace = read(kHeader + kRelease + "[1,2]\n" + "nonsense\n" +
                           "[1.5,\"a\",\"release\"]\n" + "[1,\"a\",\"release\",\"\",\"x\"]\n" +
                           "[1,\"a\",7]\n" + "[9223372036854775807,\"a\",\"stopped\"]\n" +
                           "{\"end\":false}\n" + kRelease + kEnd + kRelease);

  EXPECT_EQ(trace.records.size(), 2U);
  EXPECT_EQ(trace.reading.broken, 8U);
  EXPECT_EQ(trace.reading.first_broken, 3U);
  EXPECT_THAT(trace.reading.first_reason, HasSubstr("three to six members"));
}

TEST(TraceFile, SkipsAndCountsEventsOfLaterVersions) {
  const Trace trace = read(kHeader + "[1,\"a\",\"teleported\",\"\",1,2]\n" + kRelease + kEnd);

  EXPECT_EQ(trace.reading.unknown, 1U);
  EXPECT_EQ(trace.reading.broken, 0U);
  EXPECT_EQ(trace.records.size(), 1U);
}

TEST(TraceFile, KeepsNothingOfALineThatIsTooLong) {
  const Trace trace =
      read(kHeader + "[1,\"" + std::string(3 * kLongestLine, 'x') + "\",\"stopped\"]\n" + kRelease);

  EXPECT_EQ(trace.reading.broken, 1U);
  EXPECT_THAT(trace.reading.first_reason, HasSubstr("too long"));
  EXPECT_EQ(trace.records.size(), 1U);
}

TEST(TraceFile, ReadsValuesOfUsersAsNumbers) {
  const Trace trace = read(kHeader + "[1,\"a\",\"user\",\"gain\",0,0.25]\n" +
                           "[2,\"a\",\"user\",\"gain\",0,null]\n" + "[3,\"a\",\"user\",\"go\"]\n");

  ASSERT_EQ(trace.records.size(), 3U);
  EXPECT_EQ(trace.records[0].value(), 0.25);
  EXPECT_TRUE(std::isnan(trace.records[1].value()));
  EXPECT_EQ(trace.records[2].value(), 0.0);
}

TEST(TraceFile, ComesBackAsItWasWritten) {
  const Trace made = MadeTrace(1).make(5, 100'000'000, 2, 50);
  std::ostringstream first;
  write(made, first);
  const Trace again = read(first.str());
  std::ostringstream second;
  write(again, second);

  EXPECT_EQ(first.str(), second.str());
  EXPECT_TRUE(again.reading.complete);
  EXPECT_EQ(again.records.size(), made.records.size());
}

TEST(TraceFile, ThatIsNotThereIsRefusedInTheWordsOfTheSystem) {
  EXPECT_THAT(read_file("/no/such/file").error().message, HasSubstr("No such file or directory"));
  EXPECT_THAT(read_file("/tmp").error().message, HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace mauve::ctl::mtrace
