// SPDX-License-Identifier: LGPL-3.0-or-later
/// A call into the system that does not return until it is let go.
#pragma once

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>

namespace mauve::test {

class Block {
 public:
  Block() {
    if (pipe(ends_.data()) != 0) std::abort();
  }
  ~Block() {
    for (const int end : ends_) close(end);
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  void wait() {
    entered.store(true);
    char byte = 0;
    if (read(ends_[0], &byte, 1) < 0) return;
  }
  void let_go() const {
    if (write(ends_[1], "", 1) < 0) std::abort();
  }
  std::atomic<bool> entered{false};

 private:
  std::array<int, 2> ends_{};
};

/// Of the test that runs.
inline Block*& block() {
  static Block* one = nullptr;
  return one;
}

}  // namespace mauve::test
