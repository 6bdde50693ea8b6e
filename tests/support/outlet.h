// SPDX-License-Identifier: LGPL-3.0-or-later
/// A device as a test sees it: a pseudo-terminal, and all bytes that were sent to it.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>

namespace mauve::test {

class Outlet {
 public:
  Outlet() {
    termios raw{};
    cfmakeraw(&raw);
    std::array<char, 64> name{};
    if (openpty(&near_, &far_, name.data(), &raw, nullptr) != 0) near_ = far_ = -1;
    path_ = name.data();
    fcntl(near_, F_SETFL, O_NONBLOCK);
    for (const int end : {near_, far_}) fcntl(end, F_SETFD, FD_CLOEXEC);  // else mauved has it too
  }
  ~Outlet() {
    close(near_);
    close(far_);
  }
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// A descriptor as a driver has one; the caller's.
  [[nodiscard]] int opened(int more = O_NONBLOCK) const {
    return open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | more);
  }
  /// Readable when bytes came.
  [[nodiscard]] int descriptor() const { return near_; }
  /// Fills the line until no byte finds room any more, since the kernel carries bytes on for a
  /// while.
  void fill() const {
    const int driver = opened();
    const std::string much(4096, 'x');
    pollfd room{driver, POLLOUT, 0};
    while (poll(&room, 1, 200) > 0) {
      while (write(driver, much.data(), much.size()) > 0) {
      }
    }
    close(driver);
  }
  /// All bytes that came so far.
  const std::string& bytes() {
    std::array<char, 4096> some{};
    for (ssize_t n = 0; (n = read(near_, some.data(), some.size())) > 0;) {
      bytes_.append(some.data(), static_cast<std::size_t>(n));
    }
    return bytes_;
  }

 private:
  int near_ = -1;
  int far_ = -1;  // so that it never hangs up
  std::string path_;
  std::string bytes_;
};

}  // namespace mauve::test
