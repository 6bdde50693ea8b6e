// SPDX-License-Identifier: LGPL-3.0-or-later
/// A device that is a pipe: all that a driver, or mauved for it, writes is kept.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>
#include <utility>

namespace mauve::test {

class PipeDevice {
 public:
  PipeDevice() { EXPECT_EQ(pipe2(ends_.data(), O_NONBLOCK | O_CLOEXEC), 0); }
  ~PipeDevice() {
    hang_up();
    close(ends_[1]);
  }
  PipeDevice(const PipeDevice&) = delete;
  PipeDevice& operator=(const PipeDevice&) = delete;

  [[nodiscard]] int descriptor() const { return ends_[1]; }
  const std::string& bytes() {
    std::array<char, 4096> some{};
    for (ssize_t n = 0; (n = read(ends_[0], some.data(), some.size())) > 0;) {
      bytes_.append(some.data(), static_cast<std::size_t>(n));
    }
    return bytes_;
  }
  void fill() const {
    const std::string much(4096, 'x');
    while (write(ends_[1], much.data(), much.size()) > 0) {
    }
  }
  void hang_up() {
    if (ends_[0] >= 0) close(std::exchange(ends_[0], -1));
  }

 private:
  std::array<int, 2> ends_{};
  std::string bytes_;
};

}  // namespace mauve::test
