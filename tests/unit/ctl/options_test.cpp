// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/options.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/help.h"
#include "render/table.h"
#include "render/words.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

using Words = std::vector<std::string>;

Invocation accepted(const Words& words) {
  auto parsed = parse_options(words);
  if (auto* misuse = std::get_if<Misuse>(&parsed)) ADD_FAILURE() << misuse->fault.message;
  if (auto* invocation = std::get_if<Invocation>(&parsed)) return std::move(*invocation);
  ADD_FAILURE() << "not a command";
  return {find_command("ping"), {}, {}};
}

Misuse refused(const Words& words) {
  auto parsed = parse_options(words);
  if (auto* misuse = std::get_if<Misuse>(&parsed)) return std::move(*misuse);
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(Options, ReadACommandWithItsArguments) {
  const auto asked = accepted({"swap-core", "control", "guidance/finite_time", "--set", "gain=0.3",
                               "--set", "name=[1, 2]", "--in-place", "--state", "drop"});

  EXPECT_EQ(asked.command->name, "swap-core");
  EXPECT_EQ(asked.arguments.one("COMPONENT"), "control");
  EXPECT_EQ(asked.arguments.one("CORE"), "guidance/finite_time");
  EXPECT_EQ(asked.arguments.all("--set"), (Words{"gain=0.3", "name=[1, 2]"}));
  EXPECT_TRUE(asked.arguments.has("--in-place"));
  EXPECT_EQ(asked.arguments.one("--state"), "drop");
}

TEST(Options, TakeAnOptionBetweenTheArguments) {
  const auto asked = accepted({"swap-core", "--set", "gain=0.3", "control", "guidance/stop"});

  EXPECT_EQ(asked.arguments.one("COMPONENT"), "control");
  EXPECT_EQ(asked.arguments.all("--set"), Words{"gain=0.3"});
}

TEST(Options, AcceptGlobalOptionsBeforeAndAfterTheCommand) {
  const auto before = accepted({"--json", "--socket", "/x", "get", "a", "b"});
  const auto after = accepted({"get", "a", "b", "--json", "--socket", "/x"});

  for (const auto* asked : {&before, &after}) {
    EXPECT_TRUE(asked->globals.json);
    EXPECT_EQ(asked->globals.socket, "/x");
    EXPECT_EQ(asked->arguments.all("ADDRESS"), (Words{"a", "b"}));
  }
}

TEST(Options, KeepAssignmentsAsTheyAreWritten) {
  const auto asked =
      accepted({"set", "a.core.x=[1,2]", "a.core.y=-3", "a.core.z={\"k\": 1}", "b.n="});

  EXPECT_EQ(asked.arguments.all("ADDRESS=VALUE"),
            (Words{"a.core.x=[1,2]", "a.core.y=-3", "a.core.z={\"k\": 1}", "b.n="}));
}

TEST(Options, ReadTheGuardsOfAChange) {
  const auto asked =
      accepted({"stop", "--all", "--if-generation", "41", "--reason", "maintenance"});

  EXPECT_EQ(asked.globals.if_generation, 41U);
  EXPECT_EQ(asked.globals.reason, "maintenance");
}

TEST(Options, RefuseTheGuardsOfAChangeElsewhere) {
  EXPECT_EQ(refused({"status", "--if-generation", "41"}).fault.exit, 2);
  EXPECT_EQ(refused({"status", "--reason", "x"}).fault.exit, 2);
}

TEST(Options, RefuseValuesThatNothingTakes) {
  for (const Words& words : {Words{"swap-core", "a", "b/c", "--budget", "12"},
                             {"lock", "non"},
                             {"lock", "none params"},
                             {"swap-core", "a", "b/c", "--state", "dropp"},
                             {"logs", "--level", "loud"},
                             {"connect", "a.ports.b", "c.d", "--max-age", "soon"},
                             {"apply", "f", "--sync", "both"},
                             {"trace", "begin"},
                             {"log", "lvl"},
                             {"quarantine", "free"},
                             {"completion", "csh"},
                             {"new", "plugin", "a"},
                             {"convert-trace", "f", "-o", "g", "--format", "vcd"},
                             {"status", "--color", "pink"}}) {
    const Misuse misuse = refused(words);
    EXPECT_EQ(misuse.fault.exit, 2) << words.back();
    EXPECT_FALSE(misuse.fault.hint.empty()) << words.back();
    EXPECT_THAT(misuse.fault.id, testing::AnyOf("usage_unknown_word", "usage_not_a_time"));
  }
  EXPECT_EQ(accepted({"lock", "params"}).arguments.one("LOCK"), "params");
  EXPECT_EQ(accepted({"timeline", "drive.mtrace"}).arguments.one("FILE"), "drive.mtrace");
  EXPECT_EQ(accepted({"log", "level", "a=warn"}).arguments.one("SETTING"), "a=warn");
  EXPECT_EQ(accepted({"logs", "--level", "warn"}).arguments.one("--level"), "warn");
}

TEST(Options, NameTheNearestCommand) {
  EXPECT_EQ(refused({"staus"}).fault.hint, "did you mean 'status'?");
  EXPECT_EQ(refused({"swap", "a", "b"}).fault.hint, "did you mean 'swap-core'?");
}

TEST(Options, NameTheCommandsThatAWordBeginsAndThoseThatOnlyLook) {
  EXPECT_EQ(refused({"stat"}).fault.hint, "did you mean 'status' or 'stats'?");
  EXPECT_EQ(refused({"sto", "a"}).fault.hint, "did you mean 'stop'?");
  EXPECT_EQ(refused({"re"}).fault.hint, "did you mean 'record' or 'reload'?")
      << "reload changes things";
}

TEST(Options, NameAMissingArgumentAsTheUsageDoes) {
  EXPECT_THAT(refused({"set"}).fault.message, testing::HasSubstr("ADDRESS=VALUE is required"));
}

TEST(Options, NameTheNearestOption) {
  EXPECT_EQ(refused({"status", "--jsn"}).fault.hint, "did you mean '--json'?");
  EXPECT_EQ(refused({"timeline", "--last"}).fault.hint, "mauvectl timeline --help");
  EXPECT_EQ(refused({"swap-core", "a", "b", "--inplace"}).fault.hint, "did you mean '--in-place'?");
}

TEST(Options, AreWrongUseWithExitCode2) {
  for (const Words& words :
       {Words{}, Words{"get"}, Words{"status", "extra"}, Words{"swap-core", "a"}, Words{"--socket"},
        Words{"connect", "a"}, Words{"--timeout", "5", "status"},
        Words{"--timeout", "-5s", "status"}, Words{"--color", "pink", "status"},
        Words{"stop", "a", "--if-generation", "x"}, Words{"stop", "a", "--if-generation", "-1"}}) {
    EXPECT_EQ(refused(words).fault.exit, 2);
  }
}

TEST(Options, NameTheEntryOfEachWrongUse) {
  EXPECT_EQ(refused({}).fault.id, "usage_missing_argument");
  EXPECT_EQ(refused({"get"}).fault.id, "usage_missing_argument");
  EXPECT_EQ(refused({"status", "--timeout"}).fault.id, "usage_missing_argument");
  EXPECT_EQ(refused({"status", "--json=please"}).fault.id, "usage_missing_argument");
  EXPECT_EQ(refused({"staus"}).fault.id, "usage_unknown_command");
  EXPECT_EQ(refused({"status", "--jsn"}).fault.id, "usage_unknown_option");
  EXPECT_EQ(refused({"status", "extra"}).fault.id, "usage_too_many_arguments");
  EXPECT_EQ(refused({"--wait", "5", "status"}).fault.id, "usage_not_a_time");
  EXPECT_EQ(refused({"status", "--reason", "x"}).fault.id, "usage_changes_nothing");
  EXPECT_EQ(refused({"stop", "a", "--if-generation", "x"}).fault.id, "usage_not_a_generation");
}

TEST(Options, AnswerWrongUseAsJsonWhereAsked) {
  EXPECT_TRUE(refused({"get", "--json"}).json);
  EXPECT_TRUE(refused({"--json", "staus"}).json);
  EXPECT_FALSE(refused({"staus"}).json);
}

TEST(Options, PrintHelpAndVersion) {
  const auto help = parse_options({"--help"});
  const auto one = parse_options({"swap-core", "--help"});
  const auto version = parse_options({"--version"});

  EXPECT_NE(std::get<Text>(help).text.find("swap-core"), std::string::npos);
  EXPECT_NE(std::get<Text>(one).text.find("mauvectl swap-core"), std::string::npos);
  EXPECT_EQ(std::get<Text>(version).text.rfind("mauvectl ", 0), 0U);
}

TEST(Help, OfOneCommandNamesItsArgumentsWithUnits) {
  const std::string text = help_text(*find_command("swap-core"), 80);

  EXPECT_EQ(text.find("Usage: mauvectl swap-core COMPONENT CORE [OPTIONS]\n\n"
                      "Replace the core of a running component.\n"),
            0U)
      << text;
  EXPECT_NE(text.find("\n  --budget DURATION"), std::string::npos) << text;
  EXPECT_NE(text.find("\n  --set NAME=VALUE"), std::string::npos) << text;
  EXPECT_NE(help_text(*find_command("apply"), 80).find("--sync cut|barrier"), std::string::npos);
  EXPECT_NE(help_text(*find_command("plot"), 80).find("-o, --output FILE"), std::string::npos);
}

TEST(Help, DoesNotSayThatACommandChangesTheSystemWhereOnlyOneOfItsFormsDoes) {
  for (const char* name : {"stats", "lock", "log", "quarantine", "plan", "set"}) {
    EXPECT_NE(
        help_text(*find_command(name), 120)
            .find("It also takes --if-generation GENERATION and --reason TEXT, for a use that "
                  "changes the system."),
        std::string::npos)
        << name;
  }
}

TEST(Help, SaysOfEveryOptionWhatItsValueIs) {
  const auto check = [](const Argument& option) {
    if (!option.is_option() || option.flag) return;
    EXPECT_NE(option.placeholder(), "VALUE") << option.name;
  };
  for (const Argument& option : global_options()) check(option);
  for (const Command& command : commands()) {
    for (const Argument& option : command.arguments) check(option);
  }
}

TEST(Help, FitsTheTerminalAndCutsNothing) {
  for (const std::size_t width : {50U, 60U, 80U, 120U}) {
    std::string text = help_text(width);
    for (const Command& command : commands()) {
      const std::string text_of_one = help_text(command, width);
      EXPECT_EQ(text_of_one.find("…"), std::string::npos);
      // An example is one line to be copied.
      text += text_of_one.substr(0, text_of_one.find("\nExample: "));
    }
    for (const auto line : lines_of(text)) EXPECT_LE(columns(line), width) << line;
  }
}

TEST(Help, IsTheSameByCommandAndByOption) {
  const auto option = parse_options({"stats", "--help"});
  const Outcome command = run("/nowhere", {"help", "stats"});

  EXPECT_EQ(command.exit, 0);
  EXPECT_EQ(command.out, std::get<Text>(option).text);
  EXPECT_NE(run("/nowhere", {"help"}).out.find("\nExit codes:\n  0 "), std::string::npos);
}

TEST(Help, NamesTheNearestCommandToAnUnknownOne) {
  const Outcome outcome = run("/nowhere", {"help", "swap"});

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.err.find("did you mean 'swap-core'?"), std::string::npos) << outcome.err;
}

TEST(Commands, AreDescribedByASentenceWithAVerb) {
  for (const Command& command : commands()) {
    EXPECT_TRUE(command.text.front() >= 'A' && command.text.front() <= 'Z') << command.name;
    EXPECT_NE(command.text.back(), '.') << command.name << ": readers add the full stop";
  }
}

TEST(Commands, HaveAnExampleThatParses) {
  for (const Command& command : commands()) {
    Words words;
    std::string word;
    for (const char letter :
         std::string(command.example.substr(0, command.example.find(" >"))) + " ") {
      if (letter != ' ') {
        word += letter;
      } else {
        words.push_back(std::exchange(word, {}));
      }
    }
    ASSERT_EQ(words.front(), "mauvectl");
    words.erase(words.begin());
    EXPECT_EQ(accepted(words).command->name, command.name);
  }
}

}  // namespace
}  // namespace mauve::ctl
