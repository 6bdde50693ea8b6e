// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mauve::ctl {
namespace {

TEST(RenderFault, HasFourParts) {
  Fault fault = protocol::fault_of(refuse(Errc::abi_mismatch, "/usr/lib/mauve/plugins/pid.so",
                                          "core 'pid' speaks ABI 2", "rebuild it"),
                                   "unchanged", 41);

  EXPECT_EQ(render_fault("swap-core arm", fault, {}),
            "error: swap-core arm: core 'pid' speaks ABI 2\n"
            "  where  : /usr/lib/mauve/plugins/pid.so\n"
            "  state  : unchanged (generation 41 still running)\n"
            "  hint   : rebuild it\n"
            "  explain: mauvectl explain abi_mismatch\n")
      << "without an entry of its own its kind explains it";
}

TEST(RenderFault, EndsWithTheCommandThatExplainsIt) {
  const Fault fault = protocol::fault_of(
      refuse({Errc::conflict, "locked"}, "a.core", "is locked", "mauvectl lock none"));

  EXPECT_THAT(render_fault("", fault, {}),
              testing::EndsWith("  hint   : mauvectl lock none\n"
                                "  explain: mauvectl explain locked\n"));
  EXPECT_EQ(fault_json(fault)["error"]["id"], "locked");
}

TEST(RenderFault, NamesTheCommandThatWasTypedAndNotItsMethod) {
  const Fault fault = protocol::fault_of(refuse({Errc::not_permitted, "role_missing"}, "param.set",
                                                "needs role operator, you have viewer", "ask"),
                                         "unchanged", 7);

  EXPECT_EQ(render_fault("set arm.gain", fault, {}),
            "error: set: the command needs role operator, you have viewer\n"
            "  state  : unchanged (generation 7 still running)\n"
            "  hint   : ask\n"
            "  explain: mauvectl explain role_missing\n");
  EXPECT_EQ(fault_json(fault)["error"]["where"], "param.set");
}

TEST(RenderFault, SaysWhatTheRobotIsInNow) {
  Fault fault = protocol::fault_of(refuse(Errc::hook_failed, "", "no"), "rolled_back", 41);
  EXPECT_NE(render_fault("", fault, {}).find("rolled back (generation 41 runs again)"),
            std::string::npos);
  fault.state = "safe";
  EXPECT_NE(render_fault("", fault, {}).find("safe, outputs"), std::string::npos);
  fault.state = "unknown";
  EXPECT_NE(render_fault("", fault, {}).find("unknown"), std::string::npos);
}

TEST(RenderFault, KnowsNoStateOfAMauvedThatDoesNotAnswer) {
  const Fault away = protocol::fault_of(protocol::kUnreachable, "there is no socket", "a.sock");
  EXPECT_THAT(render_fault("set", away, {}),
              testing::HasSubstr("  state  : not known; mauvectl changed nothing\n"));
}

TEST(RenderFault, BeginsASentenceWithoutASubjectWithTheThingThatItIsAbout) {
  const auto first_line = [](const char* command, const char* where, const char* message) {
    const std::string text =
        render_fault(command, protocol::fault_of(refuse(Errc::conflict, where, message)), {});
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(first_line("set", "arm", "did not end its job within 2 s"),
            "error: set: arm did not end its job within 2 s");
  EXPECT_EQ(first_line("load arm", "arm", "is loaded already"),
            "error: load: arm is loaded already");
  EXPECT_EQ(first_line("set a.core.x", "a.core.x", "expected a number"),
            "error: set a.core.x: expected a number");
  EXPECT_EQ(first_line("status", "", "is locked"), "error: status: is locked");
}

TEST(RenderFault, LetsNoServerSteerTheTerminal) {
  const Fault fault = protocol::fault_of(refuse(Errc::system, "", "\033[2Jgone\nerror: x"));

  EXPECT_EQ(render_fault("", fault, {}).find('\033'), std::string::npos);
}

TEST(FaultJson, HasEverythingInOneObject) {
  const Json error =
      fault_json(protocol::fault_of(refuse(Errc::unknown_name, "a.b", "no such", "c")));

  EXPECT_EQ(error, Json::parse(R"({"error": {"code": -32012, "name": "unknown_name",
    "message": "no such", "state": "unchanged", "where": "a.b", "hint": "c", "exit": 4,
    "generation": null}})"));
}

TEST(RenderErrors, PointAtLineAndColumn) {
  const Json result = Json::parse(R"({"errors":[{"line":3,"column":5,"at":"control.core.gain",
    "message":"must be positive","hint":"try 0.2"}]})");

  EXPECT_EQ(render_errors("rover.json", result, {}),
            "rover.json:3:5: error: control.core.gain: must be positive\n"
            "  hint: try 0.2\n"
            "1 error\n");
  EXPECT_EQ(render_errors("rover.json", Json::parse(R"({"errors":[]})"), {}),
            "rover.json: no errors\n");
}

TEST(RenderErrors, NameTheEntryThatExplainsEach) {
  const Json result = Json::parse(R"({"errors":[{"line":3,"column":5,"at":"control.core",
    "message":"unknown key \"gian\"","hint":"","id":"file_key_unknown"}]})");

  EXPECT_EQ(render_errors("rover.json", result, {}),
            "rover.json:3:5: error: control.core: unknown key \"gian\" [file_key_unknown]\n"
            "1 error\n");
}

}  // namespace
}  // namespace mauve::ctl
