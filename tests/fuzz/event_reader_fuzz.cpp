// SPDX-License-Identifier: LGPL-3.0-or-later
// Any bytes come in any pieces, with any ranges. The same state comes out, every axis is within -1
// to 1, and the command to the robot is within its greatest speeds.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "../../plugins/teleop/event_reader.h"
#include "../../plugins/teleop/steering.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

rover::Joystick state_of(std::span<const char> bytes, std::size_t piece, teleop::AxisRange range) {
  teleop::EventReader reader;
  reader.begin();
  reader.set_range(0, range);
  while (!bytes.empty()) {
    const std::size_t size = std::min(piece, bytes.size());
    reader.push(bytes.first(size));
    bytes = bytes.subspan(size);
  }
  return reader.shown();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  teleop::AxisRange range;
  if (size < sizeof range + 1) return 0;
  std::memcpy(&range, data, sizeof range);
  const std::size_t piece = 1 + data[sizeof range];
  const std::span<const char> bytes(reinterpret_cast<const char*>(data) + sizeof range + 1,
                                    size - sizeof range - 1);
  rover::Joystick state = state_of(bytes, piece, range);
  const rover::Joystick whole = state_of(bytes, bytes.size() + 1, range);
  require(state.buttons == whole.buttons && state.axes.size() == whole.axes.size());
  for (std::size_t i = 0; i < state.axes.size(); ++i) {
    require(state.axes[i] == whole.axes[i] && std::abs(state.axes[i]) <= 1.0F);
  }
  state.connected = true;
  if (const auto wanted = teleop::steer(state, {})) {
    require(std::abs(wanted->linear) <= 0.5 && std::abs(wanted->angular) <= 1.0);
  }
  return 0;
}
