// SPDX-License-Identifier: LGPL-3.0-or-later
// The start after an upgrade of the package, which leaves the file `continue` in the state
// directory.
#include <filesystem>

#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

constexpr const char* kNoComponents = R"({ "schema": "mauve/architecture/1", "name": "trial" })";

TEST_F(Generations, AreStartedOnceAfterTheOrderlyEndOfAnUpgrade) {
  TrialDaemon daemon(kTrial, options());
  const auto as_in_the_file = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const Json unproven = {{"values", {{"first.core.gain", 4.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", unproven)["saved"], true);
  static_cast<void>(place_.write("state/continue", ""));

  end_and_start(daemon);

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << "the last one that is confirmed";
  EXPECT_EQ(daemon.ask("status.get")["recovered"], 2);
  EXPECT_TRUE(was_logged(daemon, "generation_continued"));
  EXPECT_TRUE(daemon.says("an upgrade restarted mauved: starting generation 2")) << daemon.errors();
  EXPECT_FALSE(std::filesystem::exists(state() / "continue"));

  end_and_start(daemon);

  EXPECT_EQ(exported(daemon), as_in_the_file) << "the next orderly end is one";
}

TEST_F(Generations, AreNotStartedAfterAnUpgradeThatSomebodyElseMayHaveInvented) {
  TrialDaemon daemon(kTrial, options());
  const auto as_in_the_file = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  std::filesystem::permissions(place_.write("state/continue", ""), std::filesystem::perms(0666));

  end_and_start(daemon);

  EXPECT_EQ(exported(daemon), as_in_the_file);
  EXPECT_THAT(daemon.errors(), HasSubstr("chmod o-w " + (state() / "continue").string()));
}

TEST_F(Generations, OfAnUpgradeLeaveTheFileWhenNoneCanBeBuilt) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  static_cast<void>(place_.write("state/continue", ""));
  daemon.process().signal(SIGTERM);
  ASSERT_EQ(daemon.process().wait(), 0) << daemon.errors();
  std::filesystem::remove(daemon.plugins() / "trial.so");
  daemon.place().write("trial.json", kNoComponents);

  daemon.start();

  EXPECT_FALSE(exported(daemon)["components"].contains("first"));
  EXPECT_TRUE(daemon.says("an upgrade restarted mauved and no saved generation can be started"))
      << daemon.errors();
}

TEST_F(Generations, AreNotStartedAfterAnUpgradeWhenAFreshStartIsAskedFor) {
  TrialDaemon daemon(kTrial, options());
  const auto as_in_the_file = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  static_cast<void>(place_.write("state/continue", ""));
  daemon.process().signal(SIGTERM);
  ASSERT_EQ(daemon.process().wait(), 0) << daemon.errors();

  daemon.start({"--fresh"});

  EXPECT_EQ(exported(daemon), as_in_the_file);
  EXPECT_FALSE(std::filesystem::exists(state() / "continue")) << "it was for this start";
}

}  // namespace
}  // namespace mauve::test
