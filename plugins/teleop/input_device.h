// SPDX-License-Identifier: LGPL-3.0-or-later
/// A Linux input device as the end of a line, for a LineThread. A FIFO or a pseudo-terminal that
/// carries the same events serves as well.
#pragma once

#include <linux/input.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <mauve/serial/serial_port.h>

#include "event_reader.h"

namespace teleop {

/// A fact that only the thread of the line can know comes as an event of this type between the
/// others: no device sends it.
struct Mark {
  static constexpr std::uint16_t kType = 0xffff;
  static constexpr std::uint16_t kThere = 0;        ///< from here on it is there, all let go
  static constexpr std::uint16_t kGone = 1;         ///< no program writes into the FIFO any more
  static constexpr std::uint16_t kLowest = 0x100;   ///< and axis: its smallest value
  static constexpr std::uint16_t kHighest = 0x200;  ///< and axis: its largest value
};

class InputDevice final : public mauve::serial::LineEnd {
 public:
  /// The path that reopen() opens; while no program writes into a FIFO, it is opened anew each
  /// `retry`. [factory]
  void choose(const std::string& path, std::chrono::nanoseconds retry);

  [[nodiscard]] int number() const override { return device_.number(); }
  /// Whole events, in pieces where `into` is short.
  [[nodiscard]] std::ptrdiff_t read(std::span<char> into) override;
  /// It is only read.
  [[nodiscard]] std::ptrdiff_t write(std::string_view bytes) const override;
  void close() override { device_ = mauve::serial::Descriptor(); }
  /// Opens it, and then closes the one that was open before.
  bool reopen() override;
  [[nodiscard]] std::string name() const override { return path_; }

 private:
  static constexpr std::size_t kAtOnce = 64;  // events
  static constexpr std::size_t kAnswer =
      3 * EventReader::kAxisCodes.size() + EventReader::kKeys + 1;

  bool fetch();
  void take(std::span<const char> bytes);
  bool nobody();
  void appear();
  void ask();
  void say(std::uint16_t type, std::uint16_t code, std::int32_t value);

  mauve::serial::Descriptor device_;
  std::string path_;
  std::chrono::nanoseconds retry_{};
  std::chrono::steady_clock::time_point opened_;
  bool terminal_ = false;
  bool file_ = false;  // from its beginning it would repeat old events
  bool there_ = false;
  bool dropping_ = false;  // the kernel lost events; until the next report

  std::array<char, sizeof(input_event)> part_{};
  std::size_t part_size_ = 0;
  /// A device that appears is asked for its state, and again when some of the answer was lost.
  std::array<input_event, 1 + kAnswer + kAtOnce + kAnswer> said_{};
  std::size_t said_size_ = 0;
  std::size_t handed_ = 0;  // bytes of these
};

}  // namespace teleop
