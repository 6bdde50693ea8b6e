// SPDX-License-Identifier: LGPL-3.0-or-later
/// Fixed-capacity building blocks of real-time data types: no heap, trivially copyable.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <mauve/host/version.h>

namespace mauve {

/// A sequence of at most N items inside its owner. [any]
template <typename T, std::size_t N>
class Bounded {
 public:
  [[nodiscard]] static constexpr std::size_t capacity() { return N; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == N; }
  void clear() { size_ = 0; }
  /// Shrinks or grows (new items are T{}) to at most N items.
  void resize(std::size_t size) {
    size = std::min(size, N);
    for (std::size_t i = size_; i < size; ++i) items_[i] = T{};
    size_ = static_cast<std::uint32_t>(size);
  }
  /// False, and nothing happens, when full.
  bool push_back(const T& item) {
    if (full()) return false;
    items_[size_++] = item;
    return true;
  }
  [[nodiscard]] T& operator[](std::size_t i) { return items_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return items_[i]; }
  [[nodiscard]] T* data() { return items_.data(); }
  [[nodiscard]] const T* data() const { return items_.data(); }
  [[nodiscard]] T* begin() { return items_.data(); }
  [[nodiscard]] T* end() { return items_.data() + size_; }
  [[nodiscard]] const T* begin() const { return items_.data(); }
  [[nodiscard]] const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, N> items_{};
  std::uint32_t size_ = 0;
};

/// A string of at most N bytes inside its owner; longer text is cut. [any]
template <std::size_t N>
class Text {
 public:
  Text() = default;
  Text(std::string_view text) { *this = text; }
  Text& operator=(std::string_view text) {
    size_ = static_cast<std::uint32_t>(std::min(text.size(), N));
    std::copy_n(text.data(), size_, bytes_.data());
    return *this;
  }
  [[nodiscard]] std::string_view view() const { return {bytes_.data(), size_}; }

 private:
  std::array<char, N> bytes_{};
  std::uint32_t size_ = 0;
};

}  // namespace mauve
