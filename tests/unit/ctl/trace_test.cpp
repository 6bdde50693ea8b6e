// SPDX-License-Identifier: LGPL-3.0-or-later
// trace: what is asked, and what gets into the file.
#include <gmock/gmock.h>

#include "mtrace/file.h"
#include "support/temp_dir.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

using testing::HasSubstr;

const Json kTraceStatus = {
    {"on", true},        {"detail", true},  {"seconds", 20}, {"records", 1500},
    {"lost", 2},         {"recordings", 1}, {"since", 5},    {"flight_recorder", true},
    {"bytes", 5'000'000}};

TEST(Trace, SaysHowMuchIsKeptWhenItStarts) {
  const Scene scene({"trace", "start", "--detail", "--for", "20s"}, kTraceStatus);

  EXPECT_EQ(scene.outcome.exit, 0) << scene.outcome.err;
  ASSERT_EQ(scene.asked.size(), 1U);
  EXPECT_EQ(scene.asked[0].method, "trace.start");
  EXPECT_EQ(scene.asked[0].params, (Json{{"detail", true}, {"seconds", 20}}));
  EXPECT_THAT(scene.outcome.out, HasSubstr("tracing in detail, the last 20 s are kept"));
  EXPECT_THAT(scene.outcome.out, HasSubstr("1500 records kept, 2 records lost"));
}

TEST(Trace, RefusesWhatItCannotDoBeforeItAsks) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"trace", "start", "--for", "0s"},
                                             {"trace", "start", "--for", "1500ms"},
                                             {"trace", "dump"}}) {
    EXPECT_EQ(run("/nowhere/socket", words).exit, 2) << words.back();
  }
}

TEST(Trace, PutsAllPagesIntoOneFile) {
  const test::TempDir place;
  const auto file = place / "now.mtrace";
  std::vector<Json> asked;
  Outcome outcome;
  {
    FakeServer server([&](Peer& peer) {
      peer.say(kHello);
      for (auto request = peer.hear(); !request.id.is_null(); request = peer.hear()) {
        asked.push_back(request.params);
        const bool last = asked.size() == 2;
        const Json record = {asked.size(), "control", "release"};
        peer.answer(request, {{"recording", "snapshot-7"},
                              {"header", {{"mauve_trace", 1}, {"lost", 3}}},
                              {"records", Json::array({record})},
                              {"next", asked.size()},
                              {"end", last}});
      }
    });
    outcome = run(server.path(), {"trace", "dump", "-o", file.string()});
  }
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[1], (Json{{"recording", "snapshot-7"}, {"from", 1}, {"count", 5000}}));
  const auto written = mtrace::read_file(file.string());
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_TRUE(written->reading.complete);
  EXPECT_EQ(written->header.lost, 3U);
  ASSERT_EQ(written->records.size(), 2U);
  EXPECT_EQ(written->records[1].time, 2);
}

}  // namespace
}  // namespace mauve::ctl
