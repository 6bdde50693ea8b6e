// SPDX-License-Identifier: LGPL-3.0-or-later
// A dry run prints the same consequences as the command itself.
#include <algorithm>
#include <sstream>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

/// The lines that a command printed, without the sentences on whether the change is in force.
Words consequences(const std::string& text, const Words& sentences) {
  std::istringstream lines(text);
  Words all;
  for (std::string line; std::getline(lines, line);) {
    const auto begins = [&](const std::string& sentence) { return line.starts_with(sentence); };
    if (std::ranges::none_of(sentences, begins)) all.push_back(line);
  }
  return all;
}

/// `first` declares a budget that fits into its period of 2 ms, and into none of 1 ms.
std::string declared() {
  std::string text = unguarded();
  const std::string watchdog = R"("watchdog": "1h")";
  return text.insert(text.find(watchdog) + watchdog.size(), R"(, "budget": "1500us")");
}

class PrintedDryRun : public testing::Test {
 protected:
  void SetUp() override { daemon.ask("status.get"); }  // it has started
  /// Runs the command dry, then in earnest: both print the same. Returns that.
  std::string same_in_both(Words words, const std::string& done) {
    const auto real = words;
    words.emplace_back("--dry-run");
    const auto before = daemon.ask("status.get")["generation"];
    const auto planned = daemon.ctl(words);
    EXPECT_EQ(planned.exit, 0) << planned.err;
    EXPECT_EQ(daemon.ask("status.get")["generation"], before) << "nothing was changed";
    const auto made = daemon.ctl(real);
    EXPECT_EQ(made.exit, 0) << made.err;
    EXPECT_EQ(consequences(planned.out, {"everything is prepared", "nothing was changed"}),
              consequences(made.out, {done}));
    return planned.out;
  }

  TrialDaemon daemon{declared()};
};

TEST_F(PrintedDryRun, OfAValuePrintsTheWarningsOfTheChange) {
  EXPECT_THAT(same_in_both({"set", "first.fsm.period=1ms", "--probation=off"}, "set first"),
              HasSubstr("\nwarning: "));
}

TEST_F(PrintedDryRun, OfADisconnectionPrintsTheReadersThatGetNothing) {
  EXPECT_THAT(same_in_both({"disconnect", "first.ports.output", "--probation=off"}, "disconnected"),
              HasSubstr("\nwarning: first.ports.output"));
}

TEST_F(PrintedDryRun, OfASwapPrintsThePropertiesAndTheStateThatAreGone) {
  ASSERT_EQ(daemon
                .ctl({"swap-core", "first", "trial/brittle", "--set", "until_there=nowhere",
                      "--set", "gain=2", "--probation=off"})
                .exit,
            0);

  const auto printed = same_in_both(
      {"swap-core", "first", "trial/steady", "--state", "drop", "--defaults", "--probation=off"},
      "swapped first");

  EXPECT_THAT(printed, HasSubstr("until_there (nowhere) is gone"));
  EXPECT_THAT(printed, HasSubstr("gain has its default value"));
  EXPECT_THAT(printed, HasSubstr("is dropped"));
}

TEST_F(PrintedDryRun, OfASwapPrintsThatTheComponentStaysStopped) {
  ASSERT_EQ(daemon.ctl({"stop", "first"}).exit, 0);

  EXPECT_THAT(same_in_both({"swap-core", "first", "trial/other", "--probation=off"}, "swapped"),
              HasSubstr("first is stopped and does not run: mauvectl start first"));
}

TEST_F(PrintedDryRun, OfAFilePrintsTheWarningsOfTheChange) {
  auto text = declared();
  const std::string before = R"("2ms")";
  const auto file =
      daemon.place().write("fast.json", text.replace(text.find(before), before.size(), R"("1ms")"));

  EXPECT_THAT(same_in_both({"apply", file.string(), "--probation=off"}, "applied"),
              HasSubstr("\nwarning: "));
}

TEST_F(PrintedDryRun, OfASwapToTheSameCorePrintsThatItIsMadeAnewAndItsStateDropped) {
  const auto printed =
      same_in_both({"swap-core", "first", "trial/steady", "--state", "drop", "--probation=off"},
                   "swapped first");

  EXPECT_THAT(printed, HasSubstr("~ first.core: trial/steady, made anew\n"));
  EXPECT_THAT(printed, HasSubstr("- first.core.state: "));
}

TEST_F(PrintedDryRun, OfASwapInPlaceIsRefusedInTheWordsOfTheUser) {
  const auto refused = daemon.ctl({"swap-core", "first", "trial/other", "--in-place", "--dry-run"});

  EXPECT_EQ(refused.exit, 1);
  EXPECT_THAT(refused.err, HasSubstr("where  : --dry-run\n"));
  EXPECT_THAT(refused.err, HasSubstr("hint   : leave out --in-place "));
}

TEST_F(PrintedDryRun, OfASwapWithAPropertyThatTheNewCoreLacksNamesThisCore) {
  ASSERT_EQ(daemon.ctl({"swap-core", "first", "trial/brittle", "--probation=off"}).exit, 0);

  const auto refused =
      daemon.ctl({"swap-core", "first", "trial/steady", "--set", "until_there=nowhere"});

  EXPECT_THAT(refused.err, HasSubstr("core trial/steady has no property until_there\n"));
  EXPECT_THAT(refused.err, HasSubstr("hint   : there is gain\n"));
}

}  // namespace
}  // namespace mauve::test
