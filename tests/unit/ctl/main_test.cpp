// SPDX-License-Identifier: LGPL-3.0-or-later
// The program itself: exit codes as a shell sees them, and Ctrl-C.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "unit/ctl/fake_server.h"

namespace mauve::ctl {
namespace {

/// mauvectl, started with its outputs in one pipe.
class Program {
 public:
  explicit Program(std::vector<std::string> words) {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
    words.insert(words.begin(), MAUVECTL);
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      execv(MAUVECTL, arguments.data());
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }

  ~Program() { close(output_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void interrupt() const { kill(pid_, SIGINT); }

  /// Reads to the end, then the status of wait().
  int wait() {
    std::array<char, 4096> piece{};
    for (ssize_t size = 0; (size = read(output_, piece.data(), piece.size())) > 0;) {
      text.append(piece.data(), static_cast<std::size_t>(size));
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    return status;
  }

  std::string text;

 private:
  pid_t pid_ = -1;
  int output_ = -1;
};

int exit_of(std::vector<std::string> words) {
  Program program(std::move(words));
  const int status = program.wait();
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// A server that notes when it heard a request, and does not answer.
struct Silent {
  std::promise<void> heard;
  FakeServer server{[this](Peer& peer) {
    peer.say(kHello);
    peer.hear();
    heard.set_value();
    peer.wait_for_the_end();
  }};
};

TEST(Mauvectl, EndsWithTheCodesOfTheManual) {
  EXPECT_EQ(exit_of({"--help"}), 0);
  EXPECT_EQ(exit_of({"--version"}), 0);
  EXPECT_EQ(exit_of({}), 2);
  EXPECT_EQ(exit_of({"staus"}), 2);
  EXPECT_EQ(exit_of({"--socket", "/nowhere", "status"}), 7);
}

TEST(Mauvectl, PrintsWrongUseAsJsonWhereAsked) {
  Program program({"--json", "staus"});

  program.wait();

  const auto error = protocol::Json::parse(program.text)["error"];
  EXPECT_EQ(error["exit"], 2);
  EXPECT_EQ(error["id"], "usage_unknown_command");
}

TEST(Mauvectl, SaysAtCtrlCThatTheChangeMayGoOn) {
  Silent silent;
  Program program({"--socket", silent.server.path(), "stop", "--all"});

  silent.heard.get_future().wait();
  program.interrupt();
  const int status = program.wait();

  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  EXPECT_NE(program.text.find("may still carry out the change"), std::string::npos);
}

TEST(Mauvectl, EndsQuietlyAtCtrlCElse) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"watch", "a.read"}, {"stats"}, {"quarantine"}}) {
    Silent silent;
    std::vector<std::string> all{"--socket", silent.server.path()};
    all.insert(all.end(), words.begin(), words.end());
    Program program(std::move(all));

    silent.heard.get_future().wait();
    program.interrupt();

    EXPECT_TRUE(WIFSIGNALED(program.wait())) << words.front();
    EXPECT_EQ(program.text, "") << words.front();
  }
}

}  // namespace
}  // namespace mauve::ctl
