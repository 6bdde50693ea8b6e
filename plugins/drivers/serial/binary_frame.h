// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finds the frames of a binary protocol in a stream of bytes. `Format` describes the frames:
///
///   `static constexpr std::size_t kLongest;`  is the length of the longest whole frame that the
///                                             reader waits for.
///   `static std::size_t size(Bytes begun);`   is the length of the frame that begins here, as far
///                                             as it is known. 0: none begins; a length above
///                                             kLongest is never trusted.
///   `static bool intact(Bytes frame);`        checks the checksum.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace drivers {

using Bytes = std::span<const std::uint8_t>;

/// Keeps the bytes of the frame that has begun. One that turns out to be damaged loses only its
/// first byte: a good frame that it seemed to contain is found. All of it is [rt].
template <typename Format>
class BinaryFrames {
 public:
  enum class Event : std::uint8_t {
    none,   ///< all is looked at: push() the next byte
    other,  ///< a byte of no frame: see byte()
    frame,  ///< complete and undamaged: see frame()
    bad,    ///< a frame turned out to be damaged
  };

  /// Only after next() returned `none`.
  void push(std::uint8_t byte) {
    if (end_ == bytes_.size()) {
      std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), bytes_.end(), bytes_.begin());
      end_ -= begin_;
      begin_ = 0;
    }
    bytes_[end_++] = byte;
  }

  Event next() {
    begin_ += used_;
    used_ = 0;
    const Bytes begun(bytes_.data() + begin_, end_ - begin_);
    if (begun.empty()) {
      begin_ = end_ = 0;
      dropped_ = false;
      return Event::none;
    }
    const std::size_t size = Format::size(begun);
    if (size != 0 && size <= Format::kLongest && size > begun.size() && !dropped_) {
      return Event::none;
    }
    const bool whole = size != 0 && size <= begun.size() && size <= Format::kLongest;
    if (whole && Format::intact(begun.first(size))) {
      used_ = size;
      return Event::frame;
    }
    used_ = 1;
    return size == 0 ? Event::other : Event::bad;
  }

  /// Until the next call of next().
  [[nodiscard]] std::uint8_t byte() const { return bytes_[begin_]; }
  [[nodiscard]] Bytes frame() const { return {bytes_.data() + begin_, used_}; }
  /// All bytes from the beginning of the frame on, also of a damaged one.
  [[nodiscard]] Bytes begun() const { return {bytes_.data() + begin_, end_ - begin_}; }

  /// A frame has begun and is not complete yet.
  [[nodiscard]] bool in_frame() const { return end_ - begin_ > used_; }
  /// The rest of it will not come: next() looks for other frames in its bytes.
  void drop_begun() { dropped_ = in_frame(); }

 private:
  std::array<std::uint8_t, Format::kLongest> bytes_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t used_ = 0;  // of the bytes that next() reported last
  bool dropped_ = false;
};

}  // namespace drivers
