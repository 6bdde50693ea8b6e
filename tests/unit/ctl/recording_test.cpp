// SPDX-License-Identifier: LGPL-3.0-or-later
// record, plot and map: what arrives becomes rows and pictures.
#include "commands/recording.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "support/temp_dir.h"
#include "unit/ctl/scene.h"
#include "unit/ctl/svg_reader.h"

namespace mauve::ctl {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const Json kPose = Json::parse(R"({"fields": [
  {"name": "x", "kind": "double", "unit": "m"}, {"name": "y", "kind": "double", "unit": "m"},
  {"name": "heading", "kind": "double", "unit": "rad"}]})");

/// Describes every object in the same way, shows the samples, then goes away.
struct Shown {
  Outcome outcome;

  Shown(std::vector<std::string> words, const Json& described, const std::vector<Json>& samples) {
    FakeServer server([&](Peer& peer) {
      peer.say(kHello);
      auto request = peer.hear();
      for (; request.method != "watch.subscribe"; request = peer.hear()) {
        if (request.id.is_null()) return;  // it went away
        peer.answer(request, described);
      }
      peer.answer(request, {{"sub", 5}});
      for (const Json& sample : samples) {
        peer.say(protocol::to_line(protocol::make_notification(
                     sample.contains("count") ? "dropped" : "value", sample)) +
                 "\n");
      }
    });
    outcome = run(server.path(), std::move(words));
  }
};

Json pose_at(double seconds, double x, double y) {
  return {{"sub", 5},
          {"address", "pose.read"},
          {"value", {{"x", x}, {"y", y}, {"heading", 0.5}}},
          {"status", "new_data"},
          {"t_ns", static_cast<std::int64_t>(seconds * 1e9)}};
}

TEST(Record, WritesAColumnForEachFieldAndARowForEachValue) {
  const Shown shown({"record", "pose.read"}, kPose, {pose_at(1.5, 1, 2), pose_at(1.6, 3, 4)});

  EXPECT_EQ(shown.outcome.out,
            "time_s,pose.read.x,pose.read.y,pose.read.heading\n"
            "1.500000000,1.0,2.0,0.5\n"
            "1.600000000,3.0,4.0,0.5\n");
  EXPECT_EQ(shown.outcome.exit, 7) << "the daemon went away";
}

TEST(Record, MarksLostValuesByAnEmptyRow) {
  const Shown shown({"record", "pose.read"}, kPose,
                    {pose_at(1, 1, 2), {{"sub", 5}, {"address", "pose.read"}, {"count", 12}}});

  EXPECT_THAT(shown.outcome.out, HasSubstr("\n0.000000000,,,\n"));
}

TEST(Record, QuotesWhatWouldBreakARow) {
  const Json text = {{"sub", 5}, {"address", "a.b"}, {"value", "say \"a,b\""}, {"t_ns", 0}};
  const Json list = {{"sub", 5}, {"address", "a.b"}, {"value", {1, 2}}, {"t_ns", 0}};
  const Shown shown({"record", "a.b"}, Json::object(), {text, list});

  EXPECT_EQ(shown.outcome.out,
            "time_s,a.b\n0.000000000,\"say \"\"a,b\"\"\"\n0.000000000,\"[1,2]\"\n");
}

TEST(Record, WritesNanAndInfinityAsWordsAndNoValueAsNothing) {
  Json pose = pose_at(1.5, 1, 2);
  pose["value"] = {{"x", "nan"}, {"y", "-inf"}, {"heading", nullptr}};
  const Shown shown({"record", "pose.read"}, kPose, {pose});

  EXPECT_THAT(shown.outcome.out, HasSubstr("\n1.500000000,nan,-inf,\n"));
}

TEST(Record, SaysThatAFileCannotBeWritten) {
  const Shown shown({"record", "pose.read", "-o", "/no/such/folder/x.csv"}, kPose, {});

  EXPECT_EQ(shown.outcome.exit, 2);
  EXPECT_THAT(shown.outcome.err, HasSubstr("/no/such/folder/x.csv"));
  EXPECT_THAT(shown.outcome.err, HasSubstr("No such file or directory"));
}

TEST(Output, IsReportedWhereTheReportIsNotInTheWay) {
  const test::TempDir place;
  const std::vector<std::pair<std::string, std::string>> all = {
      {"plot", "drew 3 values"}, {"map", "drew 1 place, 0.0 m of way"}};
  for (const auto& [command, report] : all) {
    const std::string file = (place / (command + ".svg")).string();
    const Shown bare({command, "pose.read"}, kPose, {pose_at(1, 1, 2)});
    const Shown filed({command, "pose.read", "-o", file}, kPose, {pose_at(1, 1, 2)});
    const Shown json({"--json", command, "pose.read", "-o", file}, kPose, {pose_at(1, 1, 2)});

    EXPECT_THAT(bare.outcome.out, StartsWith("<svg "));
    EXPECT_THAT(bare.outcome.err, StartsWith(report + "\n"));
    EXPECT_EQ(filed.outcome.out, report + " to " + file + "\n");
    EXPECT_THAT(test::TempDir::read(file), StartsWith("<svg "));
    const std::string line = json.outcome.out.substr(0, json.outcome.out.find('\n'));
    EXPECT_EQ(Json::parse(line)["file"], file);
    EXPECT_EQ(Json::parse(line)["replaced"], true);
  }
}

TEST(Output, SaysThatItReplacesAFile) {
  const test::TempDir place;
  for (const std::string command : {"plot", "map"}) {
    const std::string file = (place / command).string();
    const std::vector<std::string> words = {command, "pose.read", "-o", file};
    const Shown first(words, kPose, {pose_at(1, 1, 2)});
    const Shown second(words, kPose, {pose_at(1, 1, 2)});

    EXPECT_THAT(first.outcome.out, HasSubstr(" to " + file + "\n"));
    EXPECT_THAT(second.outcome.out, HasSubstr(file + ", replacing the file of that name\n"));
  }
}

TEST(Output, ReplacesOnlyAFileOfItsOwnKind) {
  const test::TempDir place;
  const std::string arch = place.write("arch.json", "{}").string();
  const std::string other = place.write("notes", "{}").string();
  const std::string svg = place.write("notes.svg", "{}").string();
  const std::string csv = place.write("notes.csv", "a,b\n").string();
  std::filesystem::create_symlink(other, place / "link.svg");
  std::filesystem::create_symlink(other, place / "link.csv");
  for (const std::string command : {"plot", "map", "record"}) {
    const std::string end = command == "record" ? ".csv" : ".svg";
    for (const std::string& file :
         {arch, other, svg, csv, (place / ("link" + end)).string(), place.path().string()}) {
      EXPECT_EQ(run("/nowhere", {command, "pose.read", "-o", file}).exit, 2)
          << command << " " << file << " is refused before mauved is asked";
    }
  }
  for (const std::string& file : {arch, other, svg}) EXPECT_EQ(test::TempDir::read(file), "{}");
  EXPECT_EQ(test::TempDir::read(csv), "a,b\n");
  EXPECT_TRUE(std::filesystem::is_symlink(place / "link.svg"));
}

TEST(Output, OfGraphReplacesOnlyAPictureInTheSameLanguage) {
  const test::TempDir place;
  const std::string keep = place.write("keep", "{}").string();
  const std::string svg = place.write("a.svg", "<svg >").string();
  const Json nothing = {{"components", Json::array()}, {"resources", Json::array()}};
  EXPECT_EQ(run("/nowhere", {"graph", "-o", keep}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"graph", "--dot", "-o", svg}).exit, 2);
  EXPECT_EQ(test::TempDir::read(keep), "{}");
  EXPECT_EQ(test::TempDir::read(svg), "<svg >");
  EXPECT_EQ(Scene({"graph", "-o", svg}, nothing).outcome.exit, 0);
  EXPECT_NE(test::TempDir::read(svg), "<svg >");
  EXPECT_THAT(Scene({"graph", "-o", "-"}, nothing).outcome.out, StartsWith("digraph"));
}

TEST(Output, GoesToStandardOutputForADash) {
  for (const std::string command : {"plot", "map", "record"}) {
    const Shown dash({command, "pose.read", "-o", "-"}, kPose, {pose_at(1, 1, 2)});
    const Shown bare({command, "pose.read"}, kPose, {pose_at(1, 1, 2)});
    EXPECT_EQ(dash.outcome.out, bare.outcome.out) << command;
    EXPECT_FALSE(std::filesystem::exists("-"));
  }
}

TEST(Record, OfNoValueKeepsTheFile) {
  const test::TempDir place;
  const std::string file = place.write("e.csv", "time_s,a.b\n1.0,2\n").string();
  const std::vector<std::string> words{"record", "a.b", "--for", "1ms", "-o"};
  for (const std::string& into : {file, (place / "new.csv").string()}) {
    auto these = words;
    these.push_back(into);
    const Outcome outcome = Scene(these, Json{{"sub", 5}}).outcome;
    EXPECT_EQ(outcome.exit, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("no value arrived")) << into;
  }
  EXPECT_EQ(test::TempDir::read(file), "time_s,a.b\n1.0,2\n");
  using std::filesystem::directory_iterator;
  EXPECT_EQ(std::distance(directory_iterator(place.path()), directory_iterator()), 1)
      << "nothing is left beside it";
}

TEST(Record, KeepsTheValuesBeforeTheDaemonWent) {
  const test::TempDir place;
  const std::string file = place.write("e.csv", "time_s,old\n").string();
  const Shown shown({"record", "pose.read", "-o", file}, kPose, {pose_at(1.5, 1, 2)});

  EXPECT_EQ(shown.outcome.exit, 7);
  EXPECT_THAT(test::TempDir::read(file), HasSubstr("\n1.500000000,1.0,2.0,0.5\n"));
}

TEST(Record, RefusesATimeThatIsNone) {
  const Outcome outcome = Scene({"record", "a.b", "--for", "soon"}, Json::object()).outcome;

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("example: --for 10s"));
}

TEST(Plot, DrawsOneLineForEachNumberAndOnePanelForEachUnit) {
  const Shown shown({"plot", "pose.read"}, kPose,
                    {pose_at(1, 1, 2), pose_at(2, 3, 4), pose_at(3, 5, 6)});

  EXPECT_THAT(shown.outcome.out, StartsWith("<svg "));
  EXPECT_EQ(count_in(shown.outcome.out, "<polyline"), 3U);
  EXPECT_EQ(count_in(shown.outcome.out, "<clipPath"), 2U);
  EXPECT_THAT(shown.outcome.out, HasSubstr("pose.read.heading [rad]"));
}

TEST(Plot, IsCutWhereValuesWereLost) {
  const Json lost = {{"sub", 5}, {"address", "pose.read"}, {"count", 12}, {"t_ns", 2500000000}};
  const Shown shown({"plot", "pose.read"}, kPose,
                    {pose_at(1, 1, 2), pose_at(2, 3, 4), lost, pose_at(3, 5, 6), pose_at(4, 7, 8)});

  EXPECT_EQ(count_in(shown.outcome.out, "<polyline"), 6U);
}

TEST(Plot, RefusesWhatIsNoNumber) {
  const Outcome outcome = Scene({"plot", "a.b", "--for", "1ms"}, Json{{"sub", 5}}).outcome;

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("there was no number to plot"));
  EXPECT_THAT(outcome.err, HasSubstr("a.b"));
}

Json mode(const char* core) {
  return {{"sub", 5}, {"address", "control.core"}, {"value", core}, {"t_ns", 0}};
}

TEST(Map, ColoursTheWayByItsMode) {
  const Shown shown({"map", "pose.read", "--mode", "control.core"}, kPose,
                    {mode("a/b"), pose_at(1, 0, 0), pose_at(2, 1, 0), mode("c/d"), pose_at(3, 2, 0),
                     pose_at(4, 3, 0)});

  EXPECT_EQ(count_in(shown.outcome.out, "<polyline"), 2U);
  EXPECT_THAT(shown.outcome.out, HasSubstr(">a/b</text>"));
  EXPECT_THAT(shown.outcome.out, HasSubstr(">c/d</text>"));
}

TEST(Map, DrawsWhatALaserSaw) {
  const Json scan = Json::parse(R"({"sub": 5, "address": "scan.read", "t_ns": 0, "value":
    {"angle_min": -1.0, "angle_increment": 1.0, "range_min": 0.1, "range_max": 8.0,
     "ranges": [2.0, 8.0, 0.0]}})");
  const Shown shown({"map", "pose.read", "--scan", "scan.read"}, kPose, {pose_at(1, 0, 0), scan});

  EXPECT_EQ(count_in(shown.outcome.out, "r=\"1.2\""), 1U) << "the others are no returns";
}

TEST(Map, LeavesOutAPlaceThatIsNoNumber) {
  Json nowhere = pose_at(2, 0, 0);
  nowhere["value"]["x"] = "nan";
  const Shown with({"map", "pose.read"}, kPose, {pose_at(1, 5, 5), nowhere, pose_at(3, 6, 6)});
  const Shown without({"map", "pose.read"}, kPose, {pose_at(1, 5, 5), pose_at(3, 6, 6)});

  EXPECT_EQ(with.outcome.out, without.outcome.out);
  EXPECT_THAT(with.outcome.out, HasSubstr("<svg"));
}

TEST(Map, NeedsAPlace) {
  const Outcome outcome = Scene({"map", "a.b", "--for", "1ms"}, Json{{"sub", 5}}).outcome;

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("it never had a place with x and y"));
}

}  // namespace
}  // namespace mauve::ctl
