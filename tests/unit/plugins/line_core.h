// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts that the tests of lines share: the side of a core, and the far end of its device.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>

#include <mauve/serial/line_thread.h>

#include "support/eventually.h"

namespace mauve::test {

using mauve::serial::LineBytes;
using mauve::serial::LineThread;
using mauve::serial::PseudoTerminal;
using mauve::serial::SerialPort;

namespace fs = std::filesystem;

/// Of this process alone: tests run side by side.
inline std::string link_name(const char* name) {
  return fs::path(testing::TempDir()) /
         ("mauve_line_" + std::string(name) + "_" + std::to_string(::getpid()));
}

/// A core's side: a line, and what a job does with it.
struct Core {
  explicit Core(const std::string& device, int baud = 0) {
    EXPECT_TRUE(port.open(device, baud, SerialPort::Missing::accepted, SerialPort::Use::both));
    EXPECT_TRUE(line.start(port, 64));
  }
  ~Core() { line.stop(); }

  /// All that is there now, in a job with these bytes.
  std::string job(LineBytes& bytes) {
    line.fill(bytes);
    std::string all;
    for (auto there = bytes.ring.there(); !there.empty(); there = bytes.ring.there()) {
      all.append(there.begin(), there.end());
      bytes.ring.drop(there.size());
    }
    return all;
  }
  /// Jobs until this much came.
  std::string jobs(LineBytes& bytes, std::size_t size) {
    std::string all;
    EXPECT_TRUE(eventually([&] { return (all += job(bytes)).size() >= size; })) << all.size();
    return all;
  }

  SerialPort port;
  LineThread line;
};

/// The bytes that the far end receives, until there are `size` of them.
inline std::string heard(const PseudoTerminal& far, std::size_t size) {
  std::string all;
  EXPECT_TRUE(eventually([&] {
    std::array<char, 512> some{};
    all.append(some.data(), far.receive(some));
    return all.size() >= size;
  })) << all.size();
  return all;
}

class Line : public testing::Test {
 protected:
  Line() { EXPECT_TRUE(far_.open("")); }
  PseudoTerminal far_;
};

}  // namespace mauve::test
