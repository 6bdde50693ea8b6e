// SPDX-License-Identifier: LGPL-3.0-or-later
// Services that a client calls, fires and writes to.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// "first" writes into a resource that counts.
std::string counting() {
  std::string text(kTrial);
  const std::string resources = R"("resources": {)";
  text.insert(text.find(resources) + resources.size(), R"( "tally": { "type": "trial/tally" },)");
  const std::string output = R"("output": "signal.write")";
  return text.replace(text.find(output), output.size(), R"("output": "tally.note")");
}

TEST(CallFromTheShell, PrintsTheResult) {
  TrialDaemon daemon(counting());
  static_cast<void>(daemon.client());

  const auto answer =
      daemon.ask("service.call", {{"service", "tally.scaled"}, {"arguments", {2.5, 4}}});

  EXPECT_EQ(answer["result"], 10.0) << answer;
  EXPECT_EQ(answer["kind"], "call");
  const auto said = daemon.ctl({"call", "tally.scaled", "2.5", "4"});
  EXPECT_EQ(said.exit, 0);
  EXPECT_THAT(said.out, HasSubstr("10"));
}

TEST(CallFromTheShell, TakesNoNumberThatIsNone) {
  TrialDaemon daemon(counting());
  static_cast<void>(daemon.client());

  const auto refused =
      daemon.ask("service.call", {{"service", "signal.write"}, {"arguments", {"nan"}}});

  EXPECT_EQ(refused["data"]["name"], "invalid_value") << refused;
  EXPECT_EQ(refused["data"]["where"], "signal.write") << refused;
}

TEST(CallFromTheShell, FiresAnEvent) {
  TrialDaemon daemon(counting());
  ASSERT_TRUE(eventually([&] { return daemon.value("tally.core.count") > 20; }));
  ASSERT_EQ(daemon.ask("component.stop", {{"all", true}})["state"], "applied");

  EXPECT_EQ(daemon.ctl({"call", "tally.forget"}).exit, 0);

  EXPECT_EQ(daemon.value("tally.core.count"), 0);
}

TEST(CallFromTheShell, IsRefusedWhileAllIsLockedAndReportedInTheLog) {
  TrialDaemon daemon(counting());
  static_cast<void>(daemon.client());
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");

  const auto refused = daemon.ask("service.call", {{"service", "tally.forget"}});
  EXPECT_EQ(refused["data"]["name"], "conflict") << refused;
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["lock"], "none");
  const Json scaled = {{"service", "tally.scaled"}, {"arguments", {2.5, 4}}};
  ASSERT_EQ(daemon.ask("service.call", scaled)["state"], "applied");

  EXPECT_TRUE(eventually([&] {
    return daemon.errors().find("applied tally.scaled [2.5, 4]") != std::string::npos;
  })) << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
