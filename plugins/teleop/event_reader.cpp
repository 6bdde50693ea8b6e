// SPDX-License-Identifier: LGPL-3.0-or-later
#include "event_reader.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

namespace teleop {
namespace {

/// Sticks count from BTN_JOYSTICK, gamepads from BTN_GAMEPAD; further buttons count on from 16.
std::optional<unsigned> button_of(std::uint16_t code) {
  if (code >= BTN_JOYSTICK && code < BTN_JOYSTICK + 16) return code - BTN_JOYSTICK;
  if (code >= BTN_GAMEPAD && code < BTN_GAMEPAD + 16) return code - BTN_GAMEPAD;
  if (code >= BTN_TRIGGER_HAPPY && code < BTN_TRIGGER_HAPPY + 16) {
    return 16 + code - BTN_TRIGGER_HAPPY;
  }
  return std::nullopt;
}

/// -1 to 1. The kernel counts to the right and backwards; the state counts to the left and forward.
float deflection(std::int32_t value, AxisRange range) {
  const double low = range.min;
  const double high = range.max;
  if (low >= high) return 0.0F;
  const double share = (2.0 * static_cast<double>(value) - low - high) / (high - low);
  return static_cast<float>(-std::clamp(share, -1.0, 1.0));
}

}  // namespace

bool EventReader::knows_key(std::uint16_t code) { return button_of(code).has_value(); }

void EventReader::begin() {
  next_ = {};
  next_.axes.resize(rover::Joystick::kAxes);
  shown_ = next_;
  size_ = 0;
  skipping_ = false;
  dropped_ = false;
}

std::size_t EventReader::push(std::span<const char> bytes) {
  std::size_t reports = 0;
  while (!bytes.empty()) {
    const std::size_t count = std::min(bytes.size(), part_.size() - size_);
    std::copy_n(bytes.begin(), count, part_.begin() + static_cast<std::ptrdiff_t>(size_));
    bytes = bytes.subspan(count);
    size_ += count;
    if (size_ < part_.size()) break;
    size_ = 0;
    input_event event;
    std::memcpy(&event, part_.data(), sizeof event);
    if (take(event)) ++reports;
  }
  return reports;
}

void EventReader::set_axis(std::size_t axis, std::int32_t value) {
  next_.axes[axis] = deflection(value, ranges_[axis]);
}

void EventReader::set_key(std::uint16_t code, bool pressed) {
  const std::optional<unsigned> button = button_of(code);
  if (!button) return;
  const std::uint32_t bit = 1U << *button;
  const auto before = static_cast<std::uint32_t>(next_.buttons);
  next_.buttons = static_cast<std::int32_t>(pressed ? before | bit : before & ~bit);
}

bool EventReader::holds() const {
  return shown_.buttons != 0 || std::ranges::any_of(shown_.axes, [](float at) { return at != 0; });
}

bool EventReader::take_dropped() {
  const bool was = dropped_;
  dropped_ = false;
  return was;
}

bool EventReader::take(const input_event& event) {
  if (event.type == EV_SYN) return finish(event.code);
  if (skipping_) return false;
  if (event.type == EV_KEY) set_key(event.code, event.value != 0);
  if (event.type == EV_ABS) {
    const auto* const at = std::find(kAxisCodes.begin(), kAxisCodes.end(), event.code);
    if (at != kAxisCodes.end()) {
      set_axis(static_cast<std::size_t>(at - kAxisCodes.begin()), event.value);
    }
  }
  return false;
}

bool EventReader::finish(std::uint16_t code) {
  if (code == SYN_DROPPED) {
    // The buttons that are held now are unknown. Letting go stops the robot, or gives it back.
    begin();
    skipping_ = dropped_ = true;
    return true;
  }
  if (code != SYN_REPORT) return false;
  if (std::exchange(skipping_, false)) return false;
  shown_ = next_;
  return true;
}

}  // namespace teleop
