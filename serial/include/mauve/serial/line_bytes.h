// SPDX-License-Identifier: LGPL-3.0-or-later
/// The received bytes of a serial line, and which line fills them.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <tuple>

#include <mauve/serial/byte_ring.h>
#include <mauve/type.h>

namespace mauve::serial {

/// The unused bytes from a device. They are part of a core's state, so that they survive a change.
/// The successor reads on here, and its own line goes on writing them once the line of its
/// predecessor has let go.
struct LineBytes {
  ByteRing<16'384> ring;     ///< the bytes
  std::uint64_t filler = 0;  ///< the line they are offered to; plus one: the line that writes them
  std::uint64_t wanted = 0;  ///< the line that shall write them
  std::uint64_t home = 0;    ///< where this is: a copy has no filler

  /// Described, so that the layout of a state that has it is compared field by field.
  static constexpr std::string_view type_name = "line_bytes/1";
  /// All members.
  static constexpr auto fields() {
    return std::tuple{
        mauve::field("ring", &LineBytes::ring), mauve::field("filler", &LineBytes::filler),
        mauve::field("wanted", &LineBytes::wanted), mauve::field("home", &LineBytes::home)};
  }
};

/// The part of a line that fills bytes. A component offers them in each job; the thread of the line
/// takes them, and lets go of them when another line wants them. A mark in the bytes states which
/// line may write into them, so that it is never more than one.
class LineFiller {
 public:
  LineFiller() = default;
  LineFiller(const LineFiller&) = delete;
  LineFiller& operator=(const LineFiller&) = delete;

  /// This line shall fill them, and no other: true when its thread has to look. To be called again
  /// in each job, which may be aborted anywhere. [rt]
  bool want(LineBytes& bytes);
  /// Until no line fills them any more, so that they can go. After the thread of this line has
  /// ended. [factory]
  void empty_handed(LineBytes& bytes) const;

  // The thread's own.

  /// Takes the bytes it was offered; lets go of those that another line wants.
  void choose();
  /// Takes offer and bytes back: the thread ends.
  void end();
  /// The bytes it fills, or none.
  [[nodiscard]] LineBytes* bytes() const { return filled_; }

 private:
  bool offer(LineBytes& bytes);
  void let_go();
  // The marks of bytes that it is offered, and of those it fills.
  [[nodiscard]] std::uint64_t id() const { return reinterpret_cast<std::uintptr_t>(this); }
  [[nodiscard]] std::uint64_t own() const { return id() + 1; }

  std::atomic<LineBytes*> offered_{nullptr};  // the thread has not claimed them yet
  LineBytes* filled_ = nullptr;               // the thread's own
};

}  // namespace mauve::serial
