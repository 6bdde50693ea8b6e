// SPDX-License-Identifier: LGPL-3.0-or-later
// A standard output that is full or closed is an error of each program, not a short file.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// The exit code of a command of the shell, whose errors are in `errors`.
int exit_of_program(const std::string& command, const std::filesystem::path& errors) {
  std::filesystem::remove(errors);
  Process shell({"/bin/sh", "-c", MAUVE_BIN_DIR "/" + command}, errors.string());
  return shell.wait();
}
int exit_of(const std::string& command, const std::filesystem::path& errors) {
  return exit_of_program("mauvectl " + command, errors);
}

TEST(FullOutput, IsAnErrorOfEachCommandThatPrints) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "NOT TESTED: there is no /dev/full";
  TrialDaemon daemon;
  daemon.ask("ping");  // it serves
  const TempDir place;
  const std::string socket = "--socket " + daemon.socket().string() + " ";
  for (const std::string& command :
       {std::string("--help"), std::string("--version"), std::string("help status"),
        std::string("completion bash"), socket + "export", socket + "status",
        socket + "status --json", socket + "metrics", socket + "graph", socket + "logs",
        socket + "watch first.core.gain", socket + "logs --follow"}) {
    EXPECT_EQ(exit_of(command + " >/dev/full", place / "errors"), 1) << command;
    EXPECT_THAT(TempDir::read(place / "errors"), HasSubstr("No space left on device")) << command;
    EXPECT_EQ(exit_of(command + " >&-", place / "errors"), 1) << command;
    EXPECT_THAT(TempDir::read(place / "errors"), HasSubstr("Bad file descriptor")) << command;
  }
}

TEST(FullOutput, IsAnErrorOfEachProgram) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "NOT TESTED: there is no /dev/full";
  const TempDir place;
  const std::string file =
      place.write("empty.json", R"({"schema": "mauve/architecture/1", "name": "empty"})");
  for (const std::string& command :
       {std::string("mauved --help"), std::string("mauved --version"), "mauved --check " + file,
        std::string("mauve-guardian --help"), std::string("mauve-stamp --help")}) {
    ASSERT_EQ(exit_of_program(command + " >/dev/null", place / "errors"), 0) << command;
    EXPECT_EQ(exit_of_program(command + " >/dev/full", place / "errors"), 1) << command;
    EXPECT_THAT(TempDir::read(place / "errors"), HasSubstr("No space left on device")) << command;
    EXPECT_EQ(exit_of_program(command + " >&-", place / "errors"), 1) << command;
    EXPECT_THAT(TempDir::read(place / "errors"), HasSubstr("Bad file descriptor")) << command;
  }
}

TEST(FullOutput, NoFileGetsTheNumberOfAClosedStream) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.value("first.core.gain"), 1.0);
  const TempDir place;

  EXPECT_EQ(exit_of("--socket " + daemon.socket().string() + " set first.core.gain=3 <&- >&-",
                    place / "errors"),
            1)
      << "the answer was written into the socket";

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
}

TEST(FullOutput, SaysThatAChangeIsInForceAllTheSame) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "NOT TESTED: there is no /dev/full";
  TrialDaemon daemon;
  ASSERT_EQ(daemon.value("first.core.gain"), 1.0);
  const TempDir place;

  EXPECT_EQ(exit_of("--socket " + daemon.socket().string() + " set first.core.gain=3 >/dev/full",
                    place / "errors"),
            1);

  EXPECT_THAT(TempDir::read(place / "errors"), HasSubstr("carries out what it was asked for"));
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
}

/// Where SIGPIPE is ignored, as systemd starts services, nothing else would end it: the port is
/// silent.
TEST(FullOutput, EndsAFollowerWhoseReaderIsGone) {
  TrialDaemon daemon;
  const std::string ctl = MAUVE_BIN_DIR "/mauvectl --socket " + daemon.socket().string();
  for (const std::string follower : {"watch count.read", "logs -f", "record count.read"}) {
    for (const std::string before : {"", "trap '' PIPE; "}) {
      Process pipe({"/bin/bash", "-c", before + ctl + " " + follower + " | true"});
      EXPECT_TRUE(eventually([&] { return !pipe.running(); })) << before << follower;
    }
  }
  EXPECT_TRUE(eventually([&] { return daemon.ask("client.list")["items"].size() == 1U; }));
}

}  // namespace
}  // namespace mauve::test
