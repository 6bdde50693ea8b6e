// SPDX-License-Identifier: LGPL-3.0-or-later
// The lines of a receipt besides its sentence.
#include <gtest/gtest.h>

#include "render/render.h"

namespace mauve::ctl {
namespace {

TEST(RenderReceipt, SaysHowLongTheProbationIs) {
  EXPECT_EQ(render_receipt("swapped control", Json::parse(R"({"generation":2,"changed":true,
    "probation":{"activations":3000,"time_ns":10000000000}})"),
                           {}),
            "swapped control (generation 2, on probation for 3000 jobs or 10.0 s)\n");
  EXPECT_EQ(render_receipt("swapped control", Json::parse(R"({"generation":2,"changed":true,
    "probation":{"activations":100,"time_ns":86400000000000}})"),
                           {}),
            "swapped control (generation 2, on probation for 100 jobs)\n");
  EXPECT_EQ(render_receipt("swapped control", Json::parse(R"({"generation":2,"changed":true,
    "probation":{"activations":3000,"time_ns":10000000000,"jobs_ns":3000000000}})"),
                           {}),
            "swapped control (generation 2, on probation for 3000 jobs or 10.0 s, about 3.0 s)\n");
}

TEST(RenderReceipt, DoesNotBlameTheChangeForReleasesThatOrdinaryThreadsMissed) {
  EXPECT_EQ(render_receipt("set a.core.x", Json::parse(R"({"generation":2,"changed":true,
    "components":[{"name":"a","pause_ns":38,"missed":43,"bytes":0}],"ordinary_threads":true})"),
                           {}),
            "set a.core.x: pause 38 ns, 43 releases missed meanwhile, on ordinary threads that the "
            "machine delays too: mauvectl doctor (generation 2)\n");
}

TEST(RenderReceipt, NamesTheRulesThatAreHeld) {
  EXPECT_EQ(render_receipt("locked all", Json::parse(R"({"generation":2,"changed":true,
    "rules_held":2,"held_rules":["gnss_lost","slow"]})"),
                           {}),
            "locked all (generation 2), 2 rules are held: gnss_lost, slow\n");
}

TEST(RenderReceipt, SaysWhatTheNewCoreHasByDefault) {
  EXPECT_EQ(render_receipt("swapped control", Json::parse(R"({"generation":2,"changed":true,
    "defaults":[{"name":"speed","before":0.6,"after":0.8}]})"),
                           {}),
            "swapped control (generation 2)\n"
            "  speed has its default value; --set NAME=VALUE keeps another\n");
}

TEST(RenderReceipt, SaysWhichPropertiesAndStatesAreGone) {
  EXPECT_EQ(render_receipt("swapped control", Json::parse(R"({"generation":2,"changed":true,
    "components":[{"name":"control","pause_ns":38,"missed":0,"bytes":0,
                   "dropped":"pi_state/2","dropped_bytes":24}],
    "gone":[{"name":"bypass","before":true}]})"),
                           {}),
            "swapped control: pause 38 ns, 0 releases missed (generation 2)\n"
            "  bypass (true) is gone: the new core has no such property\n"
            "  control: its state pi_state/2 (24 bytes) is dropped\n");
}

TEST(RenderReceipt, SaysForWhichComponentsNothingWasToDo) {
  EXPECT_EQ(render_receipt("started laser, gnss", Json::parse(R"({"generation":2,"changed":true,
    "already":["laser"],"already_state":"running"})"),
                           {}),
            "started laser, gnss (generation 2)\n"
            "  laser: running already\n");
  EXPECT_EQ(render_receipt("started laser", Json::parse(R"({"generation":2,"changed":false,
    "already":["laser"],"already_state":"running"})"),
                           {}),
            "nothing to change (generation 2 still running)\n"
            "  laser: running already\n");
}

TEST(RenderReceipt, SaysWhoDoesNotRun) {
  EXPECT_EQ(render_receipt("swapped control", Json::parse(R"({"generation":2,"changed":true,
    "standing":[{"name":"control","state":"faulted","hint":"mauvectl start control"}]})"),
                           {}),
            "swapped control (generation 2)\n"
            "control is faulted and does not run: mauvectl start control\n");
}

}  // namespace
}  // namespace mauve::ctl
