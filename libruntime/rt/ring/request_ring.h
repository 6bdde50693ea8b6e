// SPDX-License-Identifier: LGPL-3.0-or-later
/// RequestRing: the requests that a component makes with mauve::request(). Wait-free, never blocks;
/// a full ring accepts nothing, and push() returns false.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <mauve/time.h>

namespace mauve::rt {

/// The name of a transaction, copied.
struct Request {
  static constexpr std::size_t kLongest = 64;

  Instant time = 0;
  std::size_t size = 0;
  std::array<char, kLongest> text{};

  [[nodiscard]] std::string_view name() const { return {text.data(), size}; }
};

/// One producer (the component's thread), one consumer ([log]).
class RequestRing {
 public:
  static constexpr std::size_t kCapacity = 8;

  /// [rt] False: full, or a name that is empty or too long.
  [[nodiscard]] bool push(Instant time, std::string_view name) {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return false;
    if (name.empty() || name.size() > Request::kLongest) return false;
    Request& request = requests_[head % kCapacity];
    request.time = time;
    request.size = name.size();
    std::copy(name.begin(), name.end(), request.text.begin());
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// [log] False when empty.
  [[nodiscard]] bool pop(Request& request) {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    request = requests_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<Request, kCapacity> requests_{};
  alignas(64) std::atomic<std::uint64_t> head_{0};
  alignas(64) std::atomic<std::uint64_t> tail_{0};
};

}  // namespace mauve::rt
