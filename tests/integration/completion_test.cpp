// SPDX-License-Identifier: LGPL-3.0-or-later
// Completion in real shells with the scripts of `mauvectl completion`, with names of a running
// system.
#include <filesystem>
#include <sstream>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsSupersetOf;

using Words = std::vector<std::string>;

bool is_installed(const std::string& shell) {
  return std::filesystem::exists("/usr/bin/" + shell) || std::filesystem::exists("/bin/" + shell);
}

class CompletionIn : public testing::Test {
 public:
  /// The lines that a shell prints for a program that has the script in "$script".
  Words lines(const std::string& shell, const Words& options, const std::string& program) {
    const std::string path = std::string("PATH=" MAUVE_BIN_DIR ":/usr/bin:/bin");
    const std::string socket = "MAUVE_SOCKET=" + daemon_.socket().string();
    const std::string script = (home_ / "script").string();
    Process made({MAUVE_BIN_DIR "/mauvectl", "completion", shell});
    static_cast<void>(home_.write("script", made.all_output()));
    Words words = {
        "/usr/bin/env",   "-i", path, socket, "HOME=" + home_.path().string(), "script=" + script,
        "LC_ALL=C.UTF-8", shell};
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"-c", program});
    Process process(words, (home_ / "errors").string());
    std::istringstream stream(process.all_output());
    Words result;
    for (std::string line; std::getline(stream, line);) result.push_back(line);
    EXPECT_EQ(TempDir::read(home_ / "errors"), "");
    return result;
  }
  /// Asks again while nothing is offered: completion waits half a second for the daemon, and a busy
  /// machine may take longer.
  template <typename Shell>
  Words offered(Shell shell, const std::string& line) {
    Words words;
    EXPECT_TRUE(eventually([&] {
      words = (this->*shell)(line);
      return !words.empty() && words.front() != "";
    })) << line;
    return words;
  }
  /// The words that bash offers for a command line; the word that is completed is the last one.
  Words bash(const std::string& line) {
    return lines("bash", {"--norc", "--noprofile"},
                 ". $script; COMP_LINE='" + line + "'; COMP_WORDS=(" + line + "); " +
                     (line.ends_with(' ') ? "COMP_WORDS+=('');" : "") +
                     "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _mauvectl; "
                     "printf '%s\\n' \"${COMPREPLY[@]}\"");
  }
  /// The words that the function of zsh hands to its completion system. Functions of the test stand
  /// in for that system.
  Words zsh(const std::string& line) {
    return lines("zsh", {"-f"},
                 "compdef() { : }; . $script; compadd() { print -l -- ${(P)4} }; "
                 "_describe() { print -l -- ${(P)2} }; _files() { print FILES }; words=(" +
                     line + (line.ends_with(' ') ? "'')" : ")") +
                     "; CURRENT=${#words}; PREFIX=${words[-1]}; _mauvectl");
  }
  Words fish(const std::string& line) {
    return lines("fish", {"--no-config"}, "source $script; complete --do-complete '" + line + "'");
  }

 protected:
  TrialDaemon daemon_;
  TempDir home_;
};

TEST_F(CompletionIn, BashOffersTheOptionsOfMauved) {
  const auto options = lines("bash", {"--norc", "--noprofile"},
                             ". $script; COMP_WORDS=(mauved --s); COMP_CWORD=1; _mauved; "
                             "printf '%s\\n' \"${COMPREPLY[@]}\"");
  EXPECT_THAT(options, ElementsAre("--socket", "--state-dir"));
}

TEST_F(CompletionIn, BashOffersCommandsOptionsAndLiveNames) {
  ASSERT_FALSE(daemon_.ask("status.get").is_null());

  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl sta"),
              ElementsAre("start", "stats", "status"));
  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl swap-core --in"), ElementsAre("--in-place"));
  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl start "), ElementsAre("first", "second"));
  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl swap-core first trial/"),
              Contains("trial/counting"));
  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl set first.core."),
              Contains("first.core.gain="));
  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl connect second.ports.input s"),
              Contains("signal.read"));
  EXPECT_THAT(offered(&CompletionIn::bash, "mauvectl apply x --sync "),
              ElementsAre("barrier", "cut"));
}

TEST_F(CompletionIn, BashOffersFilesWhereAFileIsMeant) {
  static_cast<void>(home_.write("my architecture.json", "{}"));

  const auto found = bash("mauvectl check " + (home_ / "my").string());

  EXPECT_THAT(found, ElementsAre((home_ / "my architecture.json").string()));
}

TEST_F(CompletionIn, BashReplacesOnlyWhatFollowsAnEqualsSign) {
  // bash breaks the line at '='; where nothing puts it together again the word is the value alone.
  const auto found = lines("bash", {"--norc", "--noprofile"},
                           ". $script; COMP_WORDS=(mauvectl logs --level=w); COMP_CWORD=2; "
                           "_mauvectl; printf '%s\\n' \"${COMPREPLY[@]}\"");

  EXPECT_THAT(found, ElementsAre("warn"));
}

TEST_F(CompletionIn, ZshOffersCommandsOptionsAndLiveNames) {
  if (!is_installed("zsh")) GTEST_SKIP() << "SKIPPED: zsh is not installed (scripts/setup)";
  ASSERT_FALSE(daemon_.ask("status.get").is_null());

  EXPECT_THAT(offered(&CompletionIn::zsh, "mauvectl sta"),
              Contains("status:Show the generation and one line for each component"));
  EXPECT_THAT(offered(&CompletionIn::zsh, "mauvectl start "), ElementsAre("first", "second"));
  EXPECT_THAT(offered(&CompletionIn::zsh, "mauvectl set first.core.g"),
              ElementsAre("first.core.gain="));
  EXPECT_THAT(offered(&CompletionIn::zsh, "mauvectl logs --level w"), ElementsAre("warn"));
  EXPECT_THAT(offered(&CompletionIn::zsh, "mauvectl apply "), ElementsAre("FILES"));
}

TEST_F(CompletionIn, ZshKnowsWhichCommandItIsFor) {
  if (!is_installed("zsh")) GTEST_SKIP() << "SKIPPED: zsh is not installed (scripts/setup)";

  // As `eval "$(mauvectl completion zsh)"` in a startup file.
  EXPECT_THAT(lines("zsh", {"-f"},
                    "autoload -Uz compinit; compinit -D -u; . $script; "
                    "print -- ${_comps[mauvectl]}"),
              ElementsAre("_mauvectl"));
}

TEST_F(CompletionIn, FishOffersCommandsOptionsAndLiveNames) {
  if (!is_installed("fish")) GTEST_SKIP() << "SKIPPED: fish is not installed (scripts/setup)";
  ASSERT_FALSE(daemon_.ask("status.get").is_null());

  EXPECT_THAT(offered(&CompletionIn::fish, "mauvectl sta"),
              Contains("status\tShow the generation and one line for each component"));
  EXPECT_THAT(offered(&CompletionIn::fish, "mauvectl start "), IsSupersetOf({"first", "second"}));
  EXPECT_THAT(offered(&CompletionIn::fish, "mauvectl start f"), ElementsAre("first"));
  EXPECT_THAT(offered(&CompletionIn::fish, "mauvectl set first.core.g"),
              ElementsAre("first.core.gain="));
  EXPECT_THAT(offered(&CompletionIn::fish, "mauvectl swap-core first x --st"),
              Contains(testing::StartsWith("--state")));
  EXPECT_THAT(offered(&CompletionIn::fish, "mauvectl apply x --sync "),
              ElementsAre("barrier", "cut"));
}

}  // namespace
}  // namespace mauve::test
