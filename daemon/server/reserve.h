// SPDX-License-Identifier: LGPL-3.0-or-later
/// Reserve: file descriptors that mauved gives up when the process has no others left, so that a
/// client that stops components can still connect.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <vector>

namespace mauve::server {

/// [io], but for its constructor and destructor.
class Reserve {
 public:
  static constexpr std::size_t kDescriptors = 8;

  Reserve() { refill(); }
  ~Reserve() {
    while (spend()) {
    }
  }
  Reserve(const Reserve&) = delete;
  Reserve& operator=(const Reserve&) = delete;

  /// Frees one descriptor; false when there is none left.
  bool spend() {
    if (held_.empty()) {
      return false;
    }
    close(held_.back());
    held_.pop_back();
    return true;
  }
  /// Takes as many as there are room for.
  void refill() {
    while (held_.size() < kDescriptors) {
      const int descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
      if (descriptor < 0) {
        return;
      }
      held_.push_back(descriptor);
    }
  }
  /// Also false while the process may be short of descriptors.
  [[nodiscard]] bool full() const { return held_.size() == kDescriptors; }

 private:
  std::vector<int> held_;
};

}  // namespace mauve::server
