// SPDX-License-Identifier: LGPL-3.0-or-later
#include "ubx_frame.h"

#include <algorithm>
#include <array>
#include <utility>

namespace drivers {
namespace {

constexpr std::uint8_t kFirstSync = 0xb5;
constexpr std::uint8_t kSecondSync = 0x62;

/// The classes of the chapter "UBX Class IDs"; other bytes begin no message.
constexpr std::array<std::uint8_t, 16> kClasses{0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x09, 0x0a,
                                                0x0b, 0x0d, 0x10, 0x13, 0x21, 0x27, 0x28, 0x29};

/// Fletcher's sum over class, id, length and payload.
std::pair<std::uint8_t, std::uint8_t> sums(Bytes frame) {
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (const std::uint8_t byte : frame.subspan(2, frame.size() - 4)) {
    a = static_cast<std::uint8_t>(a + byte);
    b = static_cast<std::uint8_t>(b + a);
  }
  return {a, b};
}

}  // namespace

std::size_t UbxFormat::size(Bytes begun) {
  if (begun[0] != kFirstSync) return 0;
  if (begun.size() > 1 && begun[1] != kSecondSync) return 0;
  if (begun.size() > 2 && std::find(kClasses.begin(), kClasses.end(), begun[2]) == kClasses.end()) {
    return 0;
  }
  if (begun.size() < kHeader) return kAround;
  const std::size_t size = kAround + begun[4] + 256U * begun[5];
  return size <= kLongest ? size : 0;
}

bool UbxFormat::intact(Bytes frame) {
  const auto [a, b] = sums(frame);
  return frame[frame.size() - 2] == a && frame.back() == b;
}

void ubx_seal(std::span<std::uint8_t> frame, std::uint8_t group, std::uint8_t id) {
  const std::size_t length = frame.size() - UbxFormat::kAround;
  frame[0] = kFirstSync;
  frame[1] = kSecondSync;
  frame[2] = group;
  frame[3] = id;
  frame[4] = static_cast<std::uint8_t>(length % 256U);
  frame[5] = static_cast<std::uint8_t>(length / 256U);
  const auto [a, b] = sums(frame);
  frame[frame.size() - 2] = a;
  frame[frame.size() - 1] = b;
}

}  // namespace drivers
