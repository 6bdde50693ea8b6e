// SPDX-License-Identifier: LGPL-3.0-or-later
/// PseudoTerminal: a serial line without a device. The driver opens one end by its path, a test or
/// a simulation holds the other end.
#pragma once

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

class PseudoTerminal {
 public:
  PseudoTerminal() : end_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    if (end_ < 0 || grantpt(end_) != 0 || unlockpt(end_) != 0) {
      throw std::runtime_error("no pseudo-terminal");
    }
    path_ = ptsname(end_);
    // While this end is open the line does not hang up before the driver opens it.
    driver_end_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios line{};
    tcgetattr(end_, &line);
    cfmakeraw(&line);
    tcsetattr(end_, TCSANOW, &line);
  }
  ~PseudoTerminal() {
    close(end_);
    close(driver_end_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  bool send(std::string_view bytes) const {
    return write(end_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  }

 private:
  int end_;
  int driver_end_ = -1;
  std::string path_;
};
