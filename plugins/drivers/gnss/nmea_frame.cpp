// SPDX-License-Identifier: LGPL-3.0-or-later
#include "nmea_frame.h"

namespace drivers {
namespace {

constexpr bool printable(char byte) { return byte >= ' ' && byte <= '~'; }

constexpr int hex_digit(char byte) {
  if (byte >= '0' && byte <= '9') return byte - '0';
  if (byte >= 'A' && byte <= 'F') return byte - 'A' + 10;
  if (byte >= 'a' && byte <= 'f') return byte - 'a' + 10;
  return -1;
}

constexpr bool line_end(char byte) { return byte == '\r' || byte == '\n'; }

}  // namespace

FrameReader::Event FrameReader::push(char byte) {
  switch (place_) {
    case Place::text:
      return in_text(byte);
    case Place::checksum:
      return in_checksum(byte);
    case Place::between:
      break;
  }
  return in_between(byte);
}

FrameReader::Event FrameReader::start() {
  place_ = Place::text;
  size_ = 0;
  sum_ = 0;
  address_ = true;
  return Event::none;
}

FrameReader::Event FrameReader::in_text(char byte) {
  if (byte == '*') {
    place_ = Place::checksum;
    given_ = 0;
    digits_ = 0;
    return Event::none;
  }
  if (byte == '$' || line_end(byte)) {
    const Event event = refuse();
    return byte == '$' ? (start(), event) : (in_between(byte), event);
  }
  if (address_ && (!printable(byte) || byte == ' ')) {
    // A `$` in prose or binary. A real sentence damaged here still ends in `*hh`, see in_between().
    place_ = Place::between;
    tail_ = 0;
    return Event::none;
  }
  if (!printable(byte) || size_ == kLongest) return refuse();
  if (byte == ',') address_ = false;
  text_[size_++] = byte;
  sum_ = static_cast<std::uint8_t>(sum_ ^ static_cast<std::uint8_t>(byte));
  return Event::none;
}

FrameReader::Event FrameReader::in_checksum(char byte) {
  const int digit = hex_digit(byte);
  if (digit < 0) {
    const Event event = refuse();
    if (byte == '$') return start(), event;
    in_between(byte);
    return event;
  }
  given_ = static_cast<std::uint8_t>(given_ * 16 + digit);
  if (++digits_ < 2) return Event::none;
  if (given_ != sum_ || address_) return refuse();
  ++good_;
  place_ = Place::between;
  tail_ = 0;
  line_counted_ = false;
  return Event::frame;
}

FrameReader::Event FrameReader::in_between(char byte) {
  if (byte == '$') return start();
  if (line_end(byte)) {
    // `...*hh` without its `$`: a sentence whose first byte was damaged.
    const bool headless = tail_ == 3 && !line_counted_;
    tail_ = 0;
    if (byte == '\n') line_counted_ = false;
    if (!headless) return Event::none;
    line_counted_ = true;
    ++bad_;
    return Event::bad;
  }
  if (byte == '*') {
    tail_ = 1;
  } else {
    tail_ =
        static_cast<std::uint8_t>(tail_ > 0 && tail_ < 3 && hex_digit(byte) >= 0 ? tail_ + 1 : 0);
  }
  return Event::none;
}

FrameReader::Event FrameReader::refuse() {
  // A damaged byte may look like `$` and split one sentence into two: the second half, which does
  // not begin like a sentence, is not counted again.
  const auto letter = [this](std::size_t i) { return text_[i] >= 'A' && text_[i] <= 'Z'; };
  const bool begins_like_one = size_ >= 3 && letter(0) && letter(1) && letter(2);
  place_ = Place::between;
  tail_ = 0;
  if (line_counted_ && !begins_like_one) return Event::none;
  line_counted_ = true;
  ++bad_;
  return Event::bad;
}

}  // namespace drivers
