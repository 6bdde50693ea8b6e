// SPDX-License-Identifier: LGPL-3.0-or-later
// check-trace, convert-trace and timeline as commands: exit codes, what is printed and written.
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "mtrace/file.h"
#include "support/temp_dir.h"
#include "unit/ctl/made_trace.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

using mtrace::MadeTrace;
using mtrace::Trace;
using testing::HasSubstr;
using testing::StartsWith;

/// A folder with a trace in it.
class TraceCommand : public testing::Test {
 protected:
  TraceCommand() { write(made()); }

  static Trace made() { return MadeTrace(5).make(4, 100'000'000, 2, 50); }
  void write(const Trace& trace) const {
    std::ofstream stream(file_);
    mtrace::write(trace, stream);
  }
  static Outcome run_alone(std::vector<std::string> words) {
    return run("/nowhere", std::move(words));
  }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    return test::TempDir::read(folder_ / name);
  }

  test::TempDir folder_;
  std::filesystem::path file_ = folder_ / "drive.mtrace";
};

TEST_F(TraceCommand, CheckSaysThatATraceObeysTheModel) {
  const Outcome outcome = run_alone({"check-trace", file_});

  EXPECT_EQ(outcome.exit, 0) << outcome.out;
  EXPECT_THAT(outcome.out, StartsWith("the trace obeys the model\nchecked: 4 components, "));
  EXPECT_THAT(outcome.out, HasSubstr(" changes that components took "));
  EXPECT_THAT(outcome.out, HasSubstr(" times, each at the decided release, "));
}

TEST_F(TraceCommand, CheckCountsTheJobsOverBudgetOfEachComponent) {
  Trace trace;
  trace.header.components = made().header.components;
  trace.header.to = 50'000'000;
  for (const char* component : {"c0", "c1", "c0"}) {
    mtrace::append_record(trace, 1'000'000, component, mtrace::Event::budget, {}, 900, 500);
  }
  write(trace);

  EXPECT_THAT(run_alone({"check-trace", file_}).out,
              HasSubstr("\nover budget: 2 jobs of c0, 1 job of c1; the admitted bounds do not "
                        "cover them\n"));
  const Outcome json = run_alone({"--json", "check-trace", file_});
  EXPECT_EQ(Json::parse(json.out)["checked"]["over_budget"], (Json{{"c0", 2}, {"c1", 1}}));
}

TEST_F(TraceCommand, CheckCountsTheReleasesThatWereMissed) {
  Trace trace;
  trace.header.components = made().header.components;
  trace.header.to = 50'000'000;
  for (const std::int64_t count : {17, 3}) {
    mtrace::append_record(trace, 1'000'000, "c0", mtrace::Event::missed, {}, count, count);
  }
  write(trace);
  const Outcome outcome = run_alone({"check-trace", file_});

  EXPECT_THAT(outcome.out, StartsWith("the trace obeys the model\nmissed: 20 releases, which the "
                                      "model permits to a late component\nchecked: "));
  const Outcome json = run_alone({"--json", "check-trace", file_});
  EXPECT_EQ(Json::parse(json.out)["checked"]["missed"], 20);
}

TEST_F(TraceCommand, CheckNamesTheFirstViolationAndEndsWithOne) {
  Trace trace = made();
  for (auto& record : trace.records) {
    if (record.event == mtrace::Event::release && record.a > 50'000'000) ++record.a;
  }
  write(trace);
  const Outcome outcome = run_alone({"check-trace", file_});
  const Outcome json = run_alone({"--json", "check-trace", file_});

  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.out, StartsWith("violated: c"));
  EXPECT_THAT(outcome.out, HasSubstr("\n  rule   : release\n  where  : c"));
  EXPECT_THAT(outcome.out, HasSubstr(" violations, this is the first: "));
  EXPECT_EQ(json.exit, 1);
  const Json answer = Json::parse(json.out);
  EXPECT_EQ(answer["holds"], false);
  EXPECT_EQ(answer["first"]["rule"], "release");
  EXPECT_GT(answer["first"]["line"], 1);
  EXPECT_GT(answer["violations"], 1);
}

TEST_F(TraceCommand, WhatIsNoTraceIsWrongUse) {
  std::ofstream(folder_ / "other") << "{\"mauve_trace\":9}\n";
  for (const char* name : {"missing", "other", ""}) {
    for (const char* command : {"check-trace", "timeline"}) {
      const Outcome outcome = run_alone({command, folder_ / name});
      EXPECT_EQ(outcome.exit, 2) << command << " " << name;
      EXPECT_THAT(outcome.err, HasSubstr("error: ")) << command << " " << name;
    }
  }
}

TEST_F(TraceCommand, ConvertWritesByTheNameOfTheOutput) {
  EXPECT_EQ(run_alone({"convert-trace", file_, "-o", folder_ / "drive.json"}).exit, 0);
  EXPECT_THAT(run_alone({"convert-trace", file_, "-o", folder_ / "ctf"}).out,
              testing::Not(HasSubstr("replacing")));
  EXPECT_EQ(run_alone({"convert-trace", file_, "-o", folder_ / "again.mtrace"}).exit, 0);

  EXPECT_TRUE(Json::parse(text_of("drive.json"))["traceEvents"].is_array());
  EXPECT_THAT(text_of("ctf/metadata"), StartsWith("/* CTF 1.8 */"));
  EXPECT_EQ(text_of("again.mtrace"), text_of("drive.mtrace"));
  for (const char* file : {"drive.json", "ctf", "again.mtrace"}) {
    EXPECT_THAT(run_alone({"convert-trace", file_, "-o", folder_ / file}).out,
                HasSubstr(std::string(file) + ", replacing the file of that name\n"));
  }
}

TEST_F(TraceCommand, ConvertTakesAFormatWhateverTheFileIsCalled) {
  const Outcome done =
      run_alone({"convert-trace", file_, "-o", folder_ / "x", "--format", "chrome"});

  EXPECT_EQ(done.exit, 0);
  EXPECT_THAT(done.out, StartsWith("wrote "));
  EXPECT_THAT(text_of("x"), StartsWith("{"));
}

TEST_F(TraceCommand, SaysInTheWordsOfTheSystemThatItCannotWrite) {
  for (const auto& [command, file] : std::vector<std::pair<std::string, std::string>>{
           {"convert-trace", "/no/such/folder/x.json"}, {"timeline", "/no/such/folder/x.svg"}}) {
    const Outcome outcome = run_alone({command, file_, "-o", file});
    EXPECT_EQ(outcome.exit, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr("No such file or directory")) << command;
    EXPECT_THAT(outcome.err, HasSubstr(file)) << command;
  }
}

TEST_F(TraceCommand, DoesNotReplaceTheFileThatItReads) {
  const std::string before = text_of("drive.mtrace");
  std::filesystem::create_hard_link(file_, folder_ / "same.svg");
  std::filesystem::create_symlink(file_, folder_ / "same.mtrace");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"timeline", file_, "-o", file_},
        {"timeline", file_, "-o", folder_ / "same.svg"},
        {"convert-trace", file_, "-o", file_},
        {"convert-trace", file_, "-o", folder_ / "same.mtrace"}}) {
    const Outcome outcome = run_alone(words);
    EXPECT_EQ(outcome.exit, 2) << words[0] << " " << words[3];
    EXPECT_EQ(text_of("drive.mtrace"), before) << words[0] << " " << words[3];
  }
  EXPECT_THAT(run_alone({"convert-trace", file_, "-o", file_}).err,
              HasSubstr("is the file that the command reads"));
}

TEST_F(TraceCommand, ReplacesOnlyTracesOfTheSameForm) {
  std::filesystem::create_directory(folder_ / "notes");
  for (const char* name : {"arch.json", "other.mtrace", "drive.c", "notes/metadata"}) {
    std::ofstream(folder_ / name) << "{\"components\":{}}\n";
  }
  for (const char* name : {"arch.json", "other.mtrace", "drive.c", "notes"}) {
    const Outcome outcome = run_alone({"convert-trace", file_, "-o", folder_ / name});
    EXPECT_EQ(outcome.exit, 2) << name;
    EXPECT_THAT(outcome.err, HasSubstr("is no earlier output of this kind")) << name;
  }
  EXPECT_EQ(text_of("arch.json"), "{\"components\":{}}\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "notes/stream"));
  EXPECT_THAT(run_alone({"convert-trace", file_, "-o", "-"}).err,
              HasSubstr("a trace does not go to standard output"));
}

TEST_F(TraceCommand, TimelineDrawsIntoADeviceInItsPlace) {
  const Outcome outcome = run_alone({"timeline", file_, "-o", "/dev/null"});

  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(TraceCommand, TimelineRefusesAPartOutsideTheTrace) {
  for (const std::vector<std::string>& part :
       {std::vector<std::string>{"--from", "100s"}, {"--from", "90s", "--to", "100s"}}) {
    std::vector<std::string> words{"timeline", file_, "-o", folder_ / "none.svg"};
    words.insert(words.end(), part.begin(), part.end());
    const Outcome outcome = run_alone(words);

    EXPECT_EQ(outcome.exit, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("--from lies after the trace"));
    EXPECT_THAT(outcome.err, HasSubstr("the trace goes from T0 "));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none.svg"));
  }
}

TEST_F(TraceCommand, TimelineDrawsAPartOfAFile) {
  const Outcome outcome = run_alone({"timeline", file_, "--from", "10ms", "--to", "20ms",
                                     "--component", "c0,c1", "-o", folder_ / "a.svg"});

  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("drew T0 + 0.010000000 s to T0 + 0.020000000 s to "));
  EXPECT_THAT(text_of("a.svg"), StartsWith("<svg "));
  EXPECT_THAT(text_of("a.svg"), testing::Not(HasSubstr(">c2<")));
}

TEST_F(TraceCommand, TimelineRefusesAComponentThatTheTraceDoesNotHave) {
  const Outcome outcome =
      run_alone({"timeline", file_, "--component", "c0,c9", "-o", folder_ / "none.svg"});

  EXPECT_EQ(outcome.exit, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("the trace has no component c9"));
  EXPECT_THAT(outcome.err, HasSubstr("it has c0, c1, c2, c3"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.svg"));
}

TEST_F(TraceCommand, TimelineRefusesTimesThatAreNone) {
  EXPECT_EQ(run_alone({"timeline", file_, "--from", "soon"}).exit, 2);
  EXPECT_EQ(run_alone({"timeline", file_, "--from", "2s", "--to", "1s"}).exit, 2);
}

/// The whole trace in two pages.
Json page_of(const Trace& trace, const protocol::Request& request) {
  const auto from = request.params.value("from", std::size_t{0});
  const std::size_t half = trace.records.size() / 2;
  const std::size_t to = from == 0 ? half : trace.records.size();
  Json records = Json::array();
  for (std::size_t i = from; i < to; ++i) {
    records.push_back(Json::parse(record_line(trace, trace.records[i])));
  }
  return {{"header", protocol::to_json(trace.header)},
          {"records", records},
          {"recording", "now-7"},
          {"next", to},
          {"end", to == trace.records.size()}};
}

TEST_F(TraceCommand, TimelineWithoutAFileIsThatOfTheRunningSystem) {
  const Trace trace = made();
  std::vector<std::string> methods;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"timeline"}, {"timeline", "live"}}) {
    FakeServer server([&](Peer& peer) {
      peer.say(kHello);
      for (auto request = peer.hear(); !request.id.is_null(); request = peer.hear()) {
        methods.push_back(request.method + " " + request.params.value("recording", "none"));
        peer.answer(request, page_of(trace, request));
      }
    });
    const Outcome outcome = run(server.path(), words);
    EXPECT_EQ(outcome.exit, 0) << outcome.err;
    EXPECT_EQ(outcome.out, run_alone({"timeline", file_}).out);
  }
  EXPECT_THAT(methods, testing::ElementsAre("trace.read none", "trace.read now-7",
                                            "trace.read none", "trace.read now-7"));
}

TEST_F(TraceCommand, TimelineEndsThoughADaemonNeverSaysThatItIsTheEnd) {
  const Json answer{{"header", protocol::to_json(made().header)},
                    {"records", Json::array()},
                    {"next", 0},
                    {"end", false}};
  EXPECT_EQ(Scene({"timeline"}, answer).outcome.exit, 0);
  EXPECT_EQ(Scene({"timeline"}, Json::object()).outcome.exit, 1) << "no trace at all";
  EXPECT_THAT(Scene({"timeline"}, Json::array()).outcome.err, HasSubstr("no page of a trace"));
}

}  // namespace
}  // namespace mauve::ctl
