// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/terminal.h"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <string_view>

namespace mauve::ctl {
namespace {

// Another screen, no cursor, no wrapping of long lines; and back.
constexpr std::string_view kEnter = "\033[?1049h\033[?25l\033[?7l\033[2J";
constexpr std::string_view kLeave = "\033[?7h\033[?25h\033[?1049l";
constexpr std::array<int, 4> kEnding{SIGINT, SIGTERM, SIGHUP, SIGQUIT};

// Signal handlers have nothing else to look at.
termios g_before{};

bool write_all(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void restore() {
  tcsetattr(STDIN_FILENO, TCSANOW, &g_before);
  static_cast<void>(write_all(kLeave));
}

extern "C" void restore_and_end(int signal_number) {
  restore();
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

/// It interrupts the wait, which is all.
extern "C" void wake_up(int /*signal_number*/) {}

void handle(int signal_number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal_number, &action, nullptr);
}

/// Only a wait is interrupted by a change of size.
void block_resize(int how, sigset_t* before = nullptr) {
  sigset_t resize;
  sigemptyset(&resize);
  sigaddset(&resize, SIGWINCH);
  sigprocmask(how, &resize, before);
}

timespec time_until(Terminal::Deadline deadline) {
  const auto left = std::max(deadline - std::chrono::steady_clock::now(),
                             std::chrono::steady_clock::duration::zero());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  return {static_cast<time_t>(seconds.count()),
          static_cast<long>(std::chrono::nanoseconds(left - seconds).count())};
}

}  // namespace

bool Terminal::is_there() {
  const char* const kind = std::getenv("TERM");
  const bool obeys = kind != nullptr && *kind != '\0' && std::string_view(kind) != "dumb";
  return obeys && isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
}

Terminal::Terminal() {
  tcgetattr(STDIN_FILENO, &g_before);
  for (const int one : kEnding) handle(one, restore_and_end);
  handle(SIGWINCH, wake_up);
  block_resize(SIG_BLOCK);
  termios raw = g_before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;  // the screen would stay behind
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  gone_ = !write_all(kEnter);
}

Terminal::~Terminal() {
  restore();
  for (const int one : kEnding) handle(one, SIG_DFL);
  handle(SIGWINCH, SIG_DFL);
  block_resize(SIG_UNBLOCK);
}

Extent Terminal::extent() const {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
    return {};
  }
  return {size.ws_col, size.ws_row};
}

void Terminal::draw(const std::vector<std::string>& lines) {
  std::string text = "\033[H";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += (i > 0 ? "\r\n" : "") + lines[i] + "\033[K";
  }
  gone_ = gone_ || !write_all(text + "\033[J");
}

std::optional<std::string> Terminal::wait(Deadline deadline) {
  if (gone_) return std::nullopt;
  sigset_t unblocked;
  sigprocmask(SIG_BLOCK, nullptr, &unblocked);
  sigdelset(&unblocked, SIGWINCH);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  const timespec left = time_until(deadline);
  if (ppoll(&input, 1, &left, &unblocked) <= 0) return std::string{};
  std::array<char, 256> bytes{};
  const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count > 0) return std::string(bytes.data(), static_cast<std::size_t>(count));
  if (count < 0 && errno == EINTR) return std::string{};
  return std::nullopt;  // hung up
}

}  // namespace mauve::ctl
