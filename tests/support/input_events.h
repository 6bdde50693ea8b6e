// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bytes as a Linux input device sends them.
#pragma once

#include <linux/input.h>

#include <cstdint>
#include <string>

namespace mauve::test {

/// `InputEvents().axis(ABS_X, 100).key(BTN_SOUTH, 1).report().bytes()`
class InputEvents {
 public:
  InputEvents& axis(std::uint16_t code, std::int32_t value) { return add(EV_ABS, code, value); }
  InputEvents& key(std::uint16_t code, std::int32_t value) { return add(EV_KEY, code, value); }
  InputEvents& report() { return add(EV_SYN, SYN_REPORT, 0); }
  InputEvents& dropped() { return add(EV_SYN, SYN_DROPPED, 0); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  InputEvents& add(std::uint16_t type, std::uint16_t code, std::int32_t value) {
    input_event event{};
    event.type = type;
    event.code = code;
    event.value = value;
    bytes_.append(reinterpret_cast<const char*>(&event), sizeof event);
    return *this;
  }

  std::string bytes_;
};

}  // namespace mauve::test
