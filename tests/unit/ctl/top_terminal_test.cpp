// SPDX-License-Identifier: LGPL-3.0-or-later
// mauvectl top in a real terminal, which is the other end of a pseudo-terminal.
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "render/table.h"
#include "support/eventually.h"
#include "unit/ctl/scene.h"
#include "unit/ctl/top_answers.h"

namespace mauve::ctl {
namespace {

constexpr const char* kBack = "\033[?1049l";

/// Answers as top asks; hangs up after so many answers.
class Daemon {
 public:
  explicit Daemon(int answers = 1'000'000)
      : server_([answers](Peer& peer) {
          peer.say(kHello);
          const TopData data = top_answers();
          for (int i = 0; i < answers; ++i) {
            const auto request = peer.hear();
            if (request.id.is_null()) return;
            peer.answer(request, request.method == "status.get" ? data.status : data.statistics);
          }
        }) {}
  [[nodiscard]] const std::string& path() const { return server_.path(); }

 private:
  FakeServer server_;
};

/// The program on a terminal of its own.
class OnTerminal {
 public:
  OnTerminal(const std::string& socket, std::vector<std::string> words) {
    words.insert(words.begin(), {MAUVECTL, "--socket", socket, "top"});
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    winsize size{24, 100, 0, 0};
    std::array<char, 64> name{};
    EXPECT_EQ(openpty(&master_, &slave_, name.data(), nullptr, &size), 0);
    fcntl(master_, F_SETFD, FD_CLOEXEC);
    tcgetattr(slave_, &before_);
    pid_ = fork();
    if (pid_ == 0) {
      setenv("TERM", "xterm", 1);
      login_tty(slave_);
      execv(MAUVECTL, arguments.data());
      _exit(127);
    }
  }
  ~OnTerminal() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    close(master_);
    close(slave_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  void type(std::string_view keys) const {
    EXPECT_EQ(write(master_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  void resize(unsigned short columns, unsigned short lines) const {
    const winsize size{lines, columns, 0, 0};
    EXPECT_EQ(ioctl(master_, TIOCSWINSZ, &size), 0);
  }
  void signal(int number) const { kill(pid_, number); }

  /// Has the condition become true of all that was written so far?
  bool shows(const std::function<bool(const std::string&)>& condition) {
    return test::eventually([&] {
      read_some();
      return condition(text);
    });
  }
  bool shows(const std::string& part) {
    return shows([&](const std::string& all) { return all.find(part) != std::string::npos; });
  }
  /// The status of wait(), and all that was written.
  int end() {
    int status = 0;
    EXPECT_TRUE(test::eventually([&] {
      read_some();
      return waitpid(pid_, &status, WNOHANG) == pid_;
    }));
    pid_ = -1;
    read_some();
    return status;
  }
  [[nodiscard]] bool is_as_before() const {
    termios now{};
    tcgetattr(slave_, &now);
    return now.c_lflag == before_.c_lflag && text.find("\033[?25h") != std::string::npos &&
           text.rfind(kBack) != std::string::npos;
  }
  [[nodiscard]] bool is_without_echo() const {
    termios now{};
    tcgetattr(slave_, &now);
    return (now.c_lflag & static_cast<tcflag_t>(ECHO | ICANON)) == 0;
  }

  std::string text;

 private:
  void read_some() {
    pollfd input{master_, POLLIN, 0};
    std::array<char, 4096> bytes{};
    while (poll(&input, 1, 0) == 1 && (input.revents & POLLIN) != 0) {
      const ssize_t count = read(master_, bytes.data(), bytes.size());
      if (count <= 0) return;
      text.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  int master_ = -1;
  int slave_ = -1;
  pid_t pid_ = -1;
  termios before_{};
};

/// The lines of the last whole picture, without escapes.
std::vector<std::string> last_picture(const std::string& text) {
  const auto end = text.rfind("\033[J");
  const auto begin = end == std::string::npos ? end : text.rfind("\033[H", end);
  if (begin == std::string::npos) return {};
  std::vector<std::string> lines{""};
  for (std::size_t at = begin; at < end; ++at) {
    if (text[at] == '\033') {
      while (at < end && !(text[at] >= 'A' && text[at] <= 'Z') && text[at] != 'm') ++at;
    } else if (text[at] == '\n') {
      lines.emplace_back();
    } else if (text[at] != '\r') {
      lines.back() += text[at];
    }
  }
  return lines;
}

bool fits(const std::vector<std::string>& lines, std::size_t width, std::size_t height) {
  if (lines.empty() || lines.size() > height) return false;
  for (const std::string& line : lines) {
    if (columns(line) > width) return false;
  }
  return true;
}

TEST(TopOnATerminal, ShowsAPictureAndLeavesTheTerminalAsItWas) {
  const Daemon daemon;
  OnTerminal top(daemon.path(), {"--interval", "1h"});
  ASSERT_TRUE(top.shows("+++")) << top.text;
  EXPECT_TRUE(top.is_without_echo());

  top.type("q");
  const int status = top.end();

  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(top.is_as_before()) << top.text;
}

TEST(TopOnATerminal, LeavesTheTerminalAsItWasAtCtrlCAndSigterm) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    const Daemon daemon;
    OnTerminal top(daemon.path(), {"--interval", "1h"});
    ASSERT_TRUE(top.shows("+++")) << top.text;

    if (number == SIGINT) {
      top.type("\003");
    } else {
      top.signal(number);
    }
    const int status = top.end();

    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number) << status;
    EXPECT_TRUE(top.is_as_before()) << top.text;
  }
}

TEST(TopOnATerminal, FitsTheNewSizeAtOnce) {
  const Daemon daemon;
  OnTerminal top(daemon.path(), {"--interval", "1h"});
  ASSERT_TRUE(top.shows("+++")) << top.text;
  ASSERT_FALSE(fits(last_picture(top.text), 20, 6));

  top.resize(20, 6);
  EXPECT_TRUE(top.shows([](const auto& text) { return fits(last_picture(text), 20, 6); }))
      << top.text;
  top.resize(120, 30);
  EXPECT_TRUE(top.shows([](const auto& text) {
    const auto lines = last_picture(text);
    return lines.size() == 30 && lines[2].find("CORE") != std::string::npos;
  })) << top.text;

  top.type("q");
  EXPECT_EQ(top.end(), 0);
}

TEST(TopOnATerminal, ShowsDetailsAtAKey) {
  const Daemon daemon;
  OnTerminal top(daemon.path(), {"--interval", "1h"});
  ASSERT_TRUE(top.shows("+++")) << top.text;

  top.type("\033[B\r");
  EXPECT_TRUE(top.shows("response")) << top.text;
  top.type("?");
  EXPECT_TRUE(top.shows("any key")) << top.text;

  top.type("xq");
  EXPECT_EQ(top.end(), 0);
}

TEST(TopOnATerminal, EndsWith7WhenTheDaemonGoesAndSaysSoOnTheOldScreen) {
  const Daemon daemon(6);
  OnTerminal top(daemon.path(), {"--interval", "100ms"});

  const int status = top.end();

  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
  EXPECT_TRUE(top.is_as_before()) << top.text;
  EXPECT_NE(top.text.find("went away", top.text.find(kBack)), std::string::npos) << top.text;
}

TEST(TopOnATerminal, EndsAfterAsManyAsAsked) {
  const Daemon daemon;
  OnTerminal top(daemon.path(), {"--interval", "100ms", "-n", "2"});

  EXPECT_EQ(top.end(), 0);
  EXPECT_TRUE(top.is_as_before()) << top.text;
}

TEST(TopWithoutATerminal, SaysSoAndHowElse) {
  const std::string command = std::string(MAUVECTL) + " top < /dev/null 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string text;
  for (int byte = 0; (byte = fgetc(pipe)) != EOF;) text += static_cast<char>(byte);
  const int status = pclose(pipe);

  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_NE(text.find("needs a terminal"), std::string::npos) << text;
  EXPECT_NE(text.find("top -b -n 1"), std::string::npos) << text;
}

TEST(TopInBatches, PrintsTablesForScripts) {
  const Daemon daemon;

  const Outcome outcome = run(daemon.path(), {"top", "-b", "-n", "2", "--interval", "100ms"});

  EXPECT_EQ(outcome.exit, 0);
  const std::string& out = outcome.out;
  EXPECT_NE(out.find("\n\nrover: "), std::string::npos) << out;
  EXPECT_EQ(out.find('\033'), std::string::npos);
  EXPECT_EQ(out.find('>'), std::string::npos) << "nothing is selected";
  EXPECT_NE(out.find("guidance/gap@1.2"), std::string::npos);
}

TEST(TopInBatches, PrintsALineOfJsonForEachLook) {
  const Daemon daemon;

  const Outcome outcome = run(daemon.path(), {"--json", "top", "-n", "2", "--interval", "100ms"});

  EXPECT_EQ(outcome.exit, 0);
  const auto end = outcome.out.find('\n');
  const Json line = Json::parse(outcome.out.substr(0, end));
  EXPECT_EQ(line["components"].size(), 4U);
  EXPECT_EQ(line["components"][0]["name"], "laser");
  EXPECT_EQ(line["components"][0]["unfinished"], true);
  EXPECT_EQ(line["components"][0]["execution_p99_ns"].dump(), "40000");
  EXPECT_NE(outcome.out.find('\n', end + 1), std::string::npos);
}

TEST(TopInBatches, RefusesWhatIsNoPace) {
  EXPECT_EQ(run("/nowhere", {"top", "-b", "-n", "0"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"top", "-b", "-n", "x"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"top", "-b", "--interval", "1ms"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"top", "-b"}).exit, 7);
}

}  // namespace
}  // namespace mauve::ctl
