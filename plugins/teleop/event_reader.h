// SPDX-License-Identifier: LGPL-3.0-or-later
/// The Linux input protocol (struct input_event of linux/input.h) as the state of a joystick.
/// Source: Documentation/input/event-codes.rst and input.rst of the kernel.
#pragma once

#include <linux/input.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../types/joystick.h"

namespace teleop {

/// The values of an axis of the device at its two ends.
struct AxisRange {
  std::int32_t min = -32767;
  std::int32_t max = 32767;
};

/// Reads events a piece at a time, cut anywhere. An event counts when the report it belongs to is
/// complete. All of it is [rt].
class EventReader {
 public:
  /// Codes of the axes, in the order in which a Joystick has them: both sticks with their triggers,
  /// and the hat.
  static constexpr std::array<std::uint16_t, rover::Joystick::kAxes> kAxisCodes{
      ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ, ABS_HAT0X, ABS_HAT0Y};

  /// A device just opened: nothing pressed, all axes in their middle.
  void begin();
  /// For the axis at this place in kAxisCodes. An empty or reversed range keeps it in its middle.
  void set_range(std::size_t axis, AxisRange range) { ranges_[axis] = range; }

  /// Is it one of the buttons that a Joystick has?
  [[nodiscard]] static bool knows_key(std::uint16_t code);
  static constexpr std::size_t kKeys = 48;  ///< that it knows

  /// Takes all of it; how many reports were completed.
  std::size_t push(std::span<const char> bytes);

  /// Is a button pressed, or an axis out of its middle?
  [[nodiscard]] bool holds() const;
  /// The kernel dropped events: all was let go, and the device should be asked. Cleared by asking.
  [[nodiscard]] bool take_dropped();
  /// Axes and buttons of the last complete report; `time` and `connected` are the driver's.
  [[nodiscard]] const rover::Joystick& shown() const { return shown_; }

 private:
  bool take(const input_event& event);
  bool finish(std::uint16_t code);
  void set_axis(std::size_t axis, std::int32_t value);
  void set_key(std::uint16_t code, bool pressed);

  std::array<AxisRange, rover::Joystick::kAxes> ranges_{};
  rover::Joystick next_;
  rover::Joystick shown_;
  std::array<char, sizeof(input_event)> part_{};
  std::size_t size_ = 0;
  bool skipping_ = false;  // until the report after a loss is complete
  bool dropped_ = false;
};

}  // namespace teleop
