// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/trace.h"

#include <bit>

#include <gtest/gtest.h>

#include "protocol/framing.h"

namespace mauve::protocol {
namespace {

std::string line(TraceKind kind, std::string_view event, std::string_view name, std::int64_t a,
                 std::int64_t b) {
  return to_line(trace_record({5, kind, 0, 0, a, b}, "control", event, name));
}

TEST(TraceRecord, LeavesOutWhatIsNothingAtItsEnd) {
  EXPECT_EQ(line(TraceKind::stopped, "stopped", "", 0, 0), R"([5,"control","stopped"])");
  EXPECT_EQ(line(TraceKind::begin, "begin", "s", 0, 0), R"([5,"control","begin","s"])");
  EXPECT_EQ(line(TraceKind::release, "release", "", 4, 0), R"([5,"control","release","",4])");
  EXPECT_EQ(line(TraceKind::release, "release", "", 0, 3), R"([5,"control","release","",0,3])");
}

TEST(TraceRecord, OfAUserAlwaysHasItsNumber) {
  const auto bits = [](double value) { return std::bit_cast<std::int64_t>(value); };
  EXPECT_EQ(line(TraceKind::user, "user", "gain", 0, bits(0.0)),
            R"([5,"control","user","gain",0,0.0])");
  EXPECT_EQ(line(TraceKind::user, "user", "gain", 0, bits(-2.5)),
            R"([5,"control","user","gain",0,-2.5])");
}

TEST(TraceHeader, HasItsFormatAndWhatTheComponentsAre) {
  TraceHeader header;
  header.lost = 7;
  header.components.push_back({});
  header.components[0].states = {{"guide", false, 0}, {"pace", true, 10}};

  Json json = to_json(header);

  EXPECT_EQ(json["mauve_trace"], kTraceFormat);
  EXPECT_EQ(json["lost"], 7);
  EXPECT_EQ(json["components"][0]["states"], Json::parse(R"([{"name": "guide", "kind": "execution"},
                            {"name": "pace", "kind": "synchronization", "wait_ns": 10}])"));
  EXPECT_FALSE(json["components"][0].contains("bound_ns")) << "none is known";
  header.components[0].bound = 9;
  EXPECT_EQ(to_json(header)["components"][0]["bound_ns"], 9);
}

TEST(TraceEnd, SaysHowMuchItWas) {
  EXPECT_EQ(to_line(trace_end(2, 3)), R"({"end":true,"lost":3,"records":2})");
}

}  // namespace
}  // namespace mauve::protocol
