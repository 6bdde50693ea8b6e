// SPDX-License-Identifier: LGPL-3.0-or-later
/// For tests with serial lines on a simulated clock, which else would run ahead of the bytes: lets
/// the machine carry the written bytes to their readers.
#pragma once

#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/eventually.h"

namespace mauve::test {

class SettledLines {
 public:
  SettledLines() {
    termios raw{};
    cfmakeraw(&raw);
    if (::openpty(&near_, &far_, nullptr, &raw, nullptr) != 0) near_ = far_ = -1;
  }
  ~SettledLines() {
    ::close(near_);
    ::close(far_);
  }
  SettledLines(const SettledLines&) = delete;
  SettledLines& operator=(const SettledLines&) = delete;

  /// The kernel carries bytes of all lines in their order: when ours has come, so have those before
  /// it. Then until no thread but this one has anything left to do, also where other programs have
  /// both processors for a while. Not for ever.
  void wait() const {
    char byte = 0;
    pollfd come{far_, POLLIN, 0};
    if (::write(near_, &byte, 1) == 1 && ::poll(&come, 1, 10'000) == 1) {
      static_cast<void>(::read(far_, &byte, 1) == 1);
    }
    static_cast<void>(eventually(others_sleep, std::chrono::seconds(1)));
  }

 private:
  static bool others_sleep() {
    const std::string mine = std::to_string(::gettid());
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
      if (task.path().filename() == mine) continue;
      std::ifstream file(task.path() / "stat");
      std::string text;
      std::getline(file, text);
      const auto name_ends = text.rfind(") ");
      if (name_ends != std::string::npos && text[name_ends + 2] == 'R') return false;
    }
    return true;
  }

  int near_ = -1;
  int far_ = -1;
};

}  // namespace mauve::test
