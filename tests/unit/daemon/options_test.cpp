// SPDX-License-Identifier: LGPL-3.0-or-later
#include "options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace mauve::daemon {
namespace {

std::variant<Options, Leave> parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "mauved");
  return parse_options(static_cast<int>(arguments.size()), arguments.data());
}

Options accepted(std::vector<const char*> arguments) {
  auto parsed = parse(std::move(arguments));
  if (const auto* leave = std::get_if<Leave>(&parsed)) {
    ADD_FAILURE() << leave->text;
    return {};
  }
  return std::get<Options>(parsed);
}

Leave left(std::vector<const char*> arguments) {
  auto parsed = parse(std::move(arguments));
  return std::holds_alternative<Leave>(parsed) ? std::get<Leave>(parsed) : Leave{-1, "accepted"};
}

TEST(Options, HaveDefaultsForAllButTheFile) {
  setenv("MAUVE_SOCKET", "/tmp/a.sock", 1);
  const auto options = accepted({"rover.json"});
  unsetenv("MAUVE_SOCKET");

  EXPECT_EQ(options.architecture, "rover.json");
  EXPECT_EQ(options.socket, "/tmp/a.sock");
  EXPECT_EQ(options.realtime, Realtime::prefer);
  EXPECT_EQ(options.plugin_dirs.size(), 1U);
  EXPECT_EQ(options.log_level, logging::Level::info);
  EXPECT_FALSE(options.check);
  EXPECT_EQ(options.prepare_within, 10s);
}

TEST(Options, TakeEverythingFromTheCommandLine) {
  const auto options =
      accepted({"rover.json", "--socket", "/s", "--plugin-dir", "/a", "--plugin-dir", "/b",
                "--realtime", "require", "--log-file", "/l", "--log-level", "debug", "--admission",
                "strict", "--prepare-within", "1.5min"});

  EXPECT_EQ(options.socket, "/s");
  EXPECT_EQ(options.plugin_dirs, (std::vector<std::string>{"/a", "/b"}));
  EXPECT_EQ(options.realtime, Realtime::require);
  EXPECT_EQ(options.admission, Admission::strict);
  EXPECT_EQ(options.prepare_within, 90s);
  EXPECT_EQ(options.log_file, "/l");
  EXPECT_EQ(options.log_level, logging::Level::debug);
}

TEST(Options, TakeTheStateDirectoryFromTheServiceManagerUnlessOneIsGiven) {
  setenv("STATE_DIRECTORY", "/var/lib/mauve:/var/lib/other", 1);
  EXPECT_EQ(accepted({"rover.json"}).state_dir, "/var/lib/mauve");
  EXPECT_EQ(accepted({"rover.json", "--state-dir", "/here"}).state_dir, "/here");
  unsetenv("STATE_DIRECTORY");
  EXPECT_EQ(accepted({"rover.json"}).state_dir, "");
}

TEST(Options, TakeTheFileBehindTheCheckFlagOrBeforeIt) {
  EXPECT_EQ(accepted({"--check", "rover.json"}).architecture, "rover.json");
  EXPECT_TRUE(accepted({"rover.json", "--check"}).check);
}

TEST(Options, TakeTheFileBehindAPluginDirectory) {
  const auto options = accepted({"--plugin-dir", "/a", "rover.json"});

  EXPECT_EQ(options.architecture, "rover.json");
  EXPECT_EQ(options.plugin_dirs, std::vector<std::string>{"/a"});
}

TEST(Options, MakeEveryPathAbsoluteBecauseMauvedLeavesItsFolderForTheArchitectures) {
  const auto here = std::filesystem::current_path();
  const auto options = accepted({"etc/a.json", "--socket", "s", "--plugin-dir", "../b",
                                 "--log-file", "l", "--state-dir", "."});

  EXPECT_EQ(options.architecture, "etc/a.json") << "messages name it as it was given";
  EXPECT_EQ(options.socket, here / "s");
  EXPECT_EQ(options.plugin_dirs, std::vector<std::string>{(here.parent_path() / "b").string()});
  EXPECT_EQ(options.log_file, here / "l");
  EXPECT_EQ(options.state_dir, (here / "").string());
}

TEST(Options, RefuseWrongUseWithTwo) {
  EXPECT_EQ(left({}).exit, 2);
  EXPECT_EQ(left({"a.json", "b.json"}).exit, 2);
  EXPECT_EQ(left({"a.json", "--realtime", "maybe"}).exit, 2);
  EXPECT_EQ(left({"a.json", "--nonsense"}).exit, 2);
  EXPECT_EQ(left({"a.json", "--log-level", "loud"}).exit, 2);
  EXPECT_EQ(left({"a.json", "--prepare-within", "0s"}).exit, 2);
  EXPECT_THAT(left({"a.json", "--prepare-within", "10"}).text, testing::HasSubstr("no unit"));
  EXPECT_THAT(left({}).text, testing::HasSubstr("hint: mauved --help"));
}

TEST(Options, PrintTheVersion) {
  const auto leave = left({"--version"});

  EXPECT_EQ(leave.exit, 0);
  EXPECT_THAT(leave.text, testing::MatchesRegex("mauved [0-9]+\\.[0-9]+\\.[0-9]+.*\n"));
}

TEST(Options, ShowExamplesInTheHelp) {
  const auto leave = left({"--help"});

  EXPECT_EQ(leave.exit, 0);
  EXPECT_THAT(leave.text, testing::HasSubstr("mauved /usr/share/mauve/rover.json"));
  EXPECT_THAT(leave.text, testing::HasSubstr("--plugin-dir"));
}

TEST(Options, DeclareTheCostsOfTheMachine) {
  EXPECT_EQ(accepted({"rover.json"}).machine, MachineCosts{});

  const auto machine = accepted({"a.json", "--machine", "wake=20us,kernel=1.5us"}).machine;

  EXPECT_EQ(machine.wake, 20us);
  EXPECT_EQ(machine.kernel, 1500ns);
  EXPECT_EQ(machine.activation, MachineCosts{}.activation) << "not named";
  for (const char* wrong :
       {"", "wake", "wake=", "wake=20", "sleep=1us", "wake=4ms", "wake=1us,x"}) {
    EXPECT_EQ(left({"a.json", "--machine", wrong}).exit, 2) << wrong;
  }
}

}  // namespace
}  // namespace mauve::daemon
