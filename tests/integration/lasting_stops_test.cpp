// SPDX-License-Identifier: LGPL-3.0-or-later
// A stop by a user outlives every end of mauved, and holds for what is not there at present.
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include "user_stop.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST_F(UserStop, OutlivesAnOrderlyEndAndEndsWithAFreshStartOnly) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  for (int end = 0; end < 2; ++end) {
    ASSERT_NO_FATAL_FAILURE(end_and_start(*daemon));
    EXPECT_EQ(state_of("second"), "stopped") << daemon->errors();
    EXPECT_EQ(state_of("first"), "running");
    EXPECT_THAT(daemon->errors(), HasSubstr("second: stays stopped, since uid "));
  }
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("second"), "stopped") << "also after a crash of that run";

  ASSERT_EQ(daemon->ask("component.stop", kEach)["saved"], true);
  ASSERT_NO_FATAL_FAILURE(end_and_start(*daemon));
  EXPECT_EQ(state_of("first"), "stopped");
  daemon->process().signal(SIGTERM);
  ASSERT_EQ(daemon->process().wait(), 0);
  daemon->start({"--fresh"});
  EXPECT_EQ(state_of("second"), "running");
  ASSERT_NO_FATAL_FAILURE(end_and_start(*daemon));
  EXPECT_EQ(state_of("second"), "running") << "the fresh start has ended the stops for good";
}

TEST_F(UserStop, StandsWhenARollbackBringsTheComponentBack) {
  begin();
  auto without = Json::parse(std::string(kTrial));
  without["components"].erase("second");
  ASSERT_EQ(apply_file(without.dump())["state"], "applied");
  const Json nobody = {{"components", {"guest"}}};
  EXPECT_THAT(daemon->ask("component.stop", nobody).value("message", ""),
              HasSubstr("no component"));

  const auto stopped = daemon->ask("component.stop", kSecondOnly);
  EXPECT_EQ(stopped["saved"], true) << stopped;
  EXPECT_THAT(notes_in(stopped), HasSubstr("second is not part of the system now"));
  ASSERT_EQ(daemon->ask("change.undo")["state"], "applied");

  EXPECT_TRUE(stands());
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("second"), "stopped") << daemon->errors();
  ASSERT_EQ(daemon->ask("component.start", kSecondOnly)["saved"], true);
  EXPECT_EQ(state_of("second"), "running");
}

TEST_F(UserStop, InStepsStandsAgainstTheirUndoAndAgainstAFile) {
  begin();
  const Json both = {{{"stop", "second"}}, {{"set", "first.core.gain"}, {"value", 3.0}}};
  ASSERT_EQ(daemon->ask("change.apply", steps(both))["saved"], true);
  ASSERT_EQ(daemon->ask("change.undo")["state"], "applied");
  EXPECT_EQ(daemon->value("first.core.gain"), 1.0);
  EXPECT_TRUE(stands());
  EXPECT_THAT(notes_in(apply_file(kTrial)), HasSubstr("second stays stopped: uid "));
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("second"), "stopped") << daemon->errors();
}

TEST_F(UserStop, InStepsStandsForWhatStandsAlready) {
  begin(supervised(
      R"({ "name": "rest", "when": "first.core.gain > 5", "do": [{ "stop": "second" }] })"));
  daemon->set("first.core.gain", 6.0);
  ASSERT_TRUE(daemon->fired("rest", 1)) << daemon->rule("rest");
  ASSERT_EQ(daemon->component("second").value("stopped_by", "nobody"), "nobody") << "but a rule";

  const auto stopped = daemon->ask("change.apply", steps({{{"stop", "second"}}}));

  EXPECT_EQ(stopped["state"], "unchanged") << stopped;
  EXPECT_EQ(stopped["saved"], true);
  EXPECT_THAT(daemon->component("second").value("stopped_by", ""), testing::StartsWith("uid "));
}

TEST_F(UserStop, InStepsThatAreRefusedStopsNothing) {
  begin();
  const Json wrong = {{{"stop", "second"}}, {{"set", "first.core.nothing"}, {"value", 1.0}}};
  EXPECT_FALSE(daemon->ask("change.apply", steps(wrong)).contains("changed"));
  EXPECT_EQ(state_of("second"), "running");
  EXPECT_FALSE(daemon->component("second").contains("stopped_by"));
}

/// The descriptor that the process would get next.
rlim_t lowest_free_in(pid_t process) {
  const auto open = std::filesystem::path("/proc") / std::to_string(process) / "fd";
  rlim_t lowest = 0;
  while (std::filesystem::is_symlink(open / std::to_string(lowest))) ++lowest;
  return lowest;
}

TEST_F(UserStop, IsSavedWhenNoDescriptorIsFree) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED)
  GTEST_SKIP() << "NOT TESTED: the sanitizer needs a descriptor of its own to look at an object";
#endif
  begin();
  auto client = daemon->client();
  ASSERT_TRUE(client.ask("ping").contains("result"));
  rlimit now{};
  ASSERT_EQ(prlimit(daemon->process().id(), RLIMIT_NOFILE, nullptr, &now), 0);
  const rlimit none{lowest_free_in(daemon->process().id()), now.rlim_max};
  ASSERT_EQ(prlimit(daemon->process().id(), RLIMIT_NOFILE, &none, nullptr), 0);
  for (const Json& which : {kSecondOnly, kEach}) {
    const auto stopped = client.ask("component.stop", which)["result"];
    EXPECT_EQ(stopped["saved"], true) << stopped;
  }
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("first"), "stopped") << daemon->errors();
}

}  // namespace
}  // namespace mauve::test
