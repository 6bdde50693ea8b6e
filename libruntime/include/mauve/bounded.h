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

/// A sequence of at most N items inside its owner: no heap, so a real-time type may hold it. Not
/// locked. [any]
/// @snippet api_examples.cpp Bounded
template <typename T, std::size_t N>
class Bounded {
 public:
  /// The largest number of items.
  [[nodiscard]] static constexpr std::size_t capacity() { return N; }
  [[nodiscard]] std::size_t size() const { return size_; }  ///< the number of items
  [[nodiscard]] bool empty() const { return size_ == 0; }   ///< there is no item
  [[nodiscard]] bool full() const { return size_ == N; }    ///< push_back() would refuse
  void clear() { size_ = 0; }                               ///< removes all items
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
  [[nodiscard]] T& operator[](std::size_t i) { return items_[i]; }  ///< item i, unchecked
  /// Item i, unchecked.
  [[nodiscard]] const T& operator[](std::size_t i) const { return items_[i]; }
  [[nodiscard]] T* data() { return items_.data(); }                     ///< the first item
  [[nodiscard]] const T* data() const { return items_.data(); }         ///< the first item
  [[nodiscard]] T* begin() { return items_.data(); }                    ///< for loops
  [[nodiscard]] T* end() { return items_.data() + size_; }              ///< for loops
  [[nodiscard]] const T* begin() const { return items_.data(); }        ///< for loops
  [[nodiscard]] const T* end() const { return items_.data() + size_; }  ///< for loops

 private:
  std::array<T, N> items_{};
  std::uint32_t size_ = 0;
};

/// A string of at most N bytes inside its owner; longer text is cut. Not locked. [any]
/// @snippet api_examples.cpp Text
template <std::size_t N>
class Text {
 public:
  Text() = default;
  Text(std::string_view text) { *this = text; }  ///< the first N bytes of the text
  /// The first N bytes of the text.
  Text& operator=(std::string_view text) {
    size_ = static_cast<std::uint32_t>(std::min(text.size(), N));
    std::copy_n(text.data(), size_, bytes_.data());
    return *this;
  }
  /// Valid as long as the object is not changed.
  [[nodiscard]] std::string_view view() const { return {bytes_.data(), size_}; }

 private:
  std::array<char, N> bytes_{};
  std::uint32_t size_ = 0;
};

}  // namespace mauve
