// SPDX-License-Identifier: LGPL-3.0-or-later
#include "xbus_frame.h"

namespace drivers {
namespace {

constexpr std::uint8_t kPreamble = 0xfa;
constexpr std::uint8_t kUnit = 0xff;  // the bus identifier of a unit that is alone on its line
constexpr std::uint8_t kExtended = 0xff;

std::uint8_t sum(Bytes bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
  return sum;
}

}  // namespace

std::size_t XbusFormat::size(Bytes begun) {
  if (begun[0] != kPreamble) return 0;
  if (begun.size() > 1 && begun[1] != kUnit) return 0;
  if (begun.size() < kHeader) return kAround;
  return begun[3] == kExtended ? kLongest + 1 : kAround + begun[3];
}

bool XbusFormat::intact(Bytes frame) { return sum(frame.subspan(1)) == 0; }

XbusStream::Event XbusStream::next() {
  for (;;) {
    switch (frames_.next()) {
      case BinaryFrames<XbusFormat>::Event::frame:
        return Event::frame;
      case BinaryFrames<XbusFormat>::Event::bad:
        return Event::bad;
      case BinaryFrames<XbusFormat>::Event::none:
        return Event::none;
      case BinaryFrames<XbusFormat>::Event::other:
        break;
    }
  }
}

void xbus_seal(std::span<std::uint8_t> frame, std::uint8_t message) {
  frame[0] = kPreamble;
  frame[1] = kUnit;
  frame[2] = message;
  frame[3] = static_cast<std::uint8_t>(frame.size() - XbusFormat::kAround);
  frame.back() = 0;
  frame.back() = static_cast<std::uint8_t>(-sum(frame.subspan(1)));
}

}  // namespace drivers
