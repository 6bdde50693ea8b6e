// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bytes from one thread to one other, wait-free.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>

#include <mauve/type.h>

namespace mauve::serial {

/// One writer, one reader. Plain data, so that it can be part of a core's state.
template <std::size_t kSize>
class ByteRing {
  static_assert(kSize > 0 && (kSize & (kSize - 1)) == 0, "a power of two");

 public:
  /// Described by the places of its marks, which lie behind the bytes.
  static constexpr std::string_view type_name = "byte_ring/1";
  /// The bytes are no field: tools show none of them.
  static constexpr auto fields() {
    return std::tuple{mauve::field("head", &ByteRing::head_),
                      mauve::field("tail", &ByteRing::tail_)};
  }

  /// In bytes.
  static constexpr std::size_t kCapacity = kSize;

  /// Bytes that wait; for either side. [rt]
  [[nodiscard]] std::size_t size() {
    // The tail first: a head that is read later is never behind it.
    const std::uint32_t tail = look(tail_);
    return look(head_) - tail;
  }

  /// The writer: room in one piece; bytes that were written there count after filled(). [rt]
  [[nodiscard]] std::span<char> room() {
    const std::size_t free = kSize - size();
    const std::size_t at = head_ % kSize;
    return std::span(bytes_).subspan(at, std::min(free, kSize - at));
  }
  /// The writer: so many bytes of room() count from now on. [rt]
  void filled(std::size_t count) { store(head_, head_ + static_cast<std::uint32_t>(count)); }
  /// All of it, at once, or false and nothing. [rt]
  [[nodiscard]] bool put(std::span<const char> bytes, std::span<const char> more = {}) {
    const std::size_t count = bytes.size() + more.size();
    if (count > kSize - size()) return false;
    std::uint32_t at = head_;
    for (const char byte : bytes) bytes_[at++ % kSize] = byte;
    for (const char byte : more) bytes_[at++ % kSize] = byte;
    filled(count);
    return true;
  }

  /// The reader: the bytes that wait, from so many on, in one piece; drop() removes them. [rt]
  [[nodiscard]] std::span<const char> there(std::size_t from = 0) {
    const std::size_t at = (tail_ + from) % kSize;
    return std::span<const char>(bytes_).subspan(at, std::min(size() - from, kSize - at));
  }
  /// The reader: removes so many bytes of there(). [rt]
  void drop(std::size_t count) { store(tail_, tail_ + static_cast<std::uint32_t>(count)); }

 private:
  static std::uint32_t look(std::uint32_t& word) {
    return std::atomic_ref(word).load(std::memory_order_acquire);
  }
  static void store(std::uint32_t& word, std::uint32_t value) {
    std::atomic_ref(word).store(value, std::memory_order_release);
  }

  std::array<char, kSize> bytes_{};
  std::uint32_t head_ = 0;  // the writer's; both only grow, and wrap
  std::uint32_t tail_ = 0;  // the reader's
};

}  // namespace mauve::serial
