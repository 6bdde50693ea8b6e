// SPDX-License-Identifier: LGPL-3.0-or-later
#include "nmea_frame.h"

#include <algorithm>
#include <utility>

namespace drivers {
namespace {

constexpr int hex_digit(char byte) {
  if (byte >= '0' && byte <= '9') return byte - '0';
  if (byte >= 'A' && byte <= 'F') return byte - 'A' + 10;
  if (byte >= 'a' && byte <= 'f') return byte - 'a' + 10;
  return -1;
}

constexpr bool line_end(char byte) { return byte == '\r' || byte == '\n'; }
constexpr bool starts(char byte) { return byte == '$' || byte == '!'; }
constexpr bool of_address(char byte) {
  return (byte >= 'A' && byte <= 'Z') || (byte >= '0' && byte <= '9');
}

void sum_up(std::uint8_t& sum, char byte) {
  sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(byte));
}

}  // namespace

FrameReader::Event FrameReader::push(char byte) {
  if (line_end(byte)) return end_line();
  const bool begins_line = std::exchange(line_start_, false);
  sealed_ = {};
  if (size_ == text_.size()) make_room();
  if (size_ == 0) {
    if (!starts(byte)) return Event::none;
    whole_ = begins_line;
    first_ = {};
  }
  add(byte, starts(byte));
  return look(byte);
}

void FrameReader::drop_begun() {
  forget();
  line_start_ = true;
}

void FrameReader::forget() {
  size_ = 0;
  starred_ = false;
  sealed_ = {};
}

void FrameReader::add(char byte, bool start) {
  if (size_ > 0) sum_up(first_.sum, byte);
  if (start) {
    last_ = {.place = size_};
  } else {
    sum_up(last_.sum, byte);
  }
  text_[size_++] = byte;
}

/// Too long from the first start on; from the last one on it may still be a sentence.
void FrameReader::make_room() {
  if (last_.place == 0) return forget();
  const std::size_t shift = std::exchange(last_.place, 0);
  std::copy(text_.begin() + static_cast<std::ptrdiff_t>(shift), text_.end(), text_.begin());
  size_ -= shift;
  first_ = last_;
  whole_ = false;
  if (starred_) star_ -= shift;
}

/// Looks for `*hh` at the end of the text. More digits than two are of another kind of log.
FrameReader::Event FrameReader::look(char byte) {
  if (byte == '*') {
    for (Start* start : {&first_, &last_}) {
      start->text = start->sum;
      sum_up(start->text, byte);
    }
    star_ = size_ - 1;
    starred_ = true;
    given_ = digits_ = 0;
    return Event::none;
  }
  const int digit = hex_digit(byte);
  if (!starred_ || digit < 0 || digits_ == 2) {
    starred_ = false;
    return Event::none;
  }
  given_ = static_cast<std::uint8_t>(given_ * 16 + digit);
  if (++digits_ < 2) return Event::none;
  for (const Start* start : {&last_, &first_}) {
    if (given_ == start->text && star_ > start->place + 1) return complete(*start);
  }
  return Event::none;
}

FrameReader::Event FrameReader::complete(const Start& start) {
  frame_ = start.place + 1;
  frame_size_ = star_ - frame_;
  const Name sealed = start.place == 0 && whole_ ? name() : Name{};
  ++good_;
  drop_begun();
  sealed_ = sealed;
  return Event::frame;
}

FrameReader::Event FrameReader::end_line() {
  if (sealed_ != Name{}) proven_.right(sealed_);
  bool damaged = false;
  if (size_ > 0 && whole_ && starred_ && digits_ == 2) {
    const Name said = name();
    // Without a right GGA there is no epoch that the gate could refuse for it.
    const bool gga = std::string_view(&said[3], 4) == std::string_view("GGA\0", 4);
    damaged = (gga && said[0] == '$') || (said != Name{} && proven_.wrong(said));
  }
  drop_begun();
  if (!damaged) return Event::none;
  ++bad_;
  return Event::bad;
}

/// Of the first sentence in the text.
FrameReader::Name FrameReader::name() const {
  Name name{};
  const auto begin = text_.begin() + 1;
  const auto end = std::find_if_not(begin, begin + name.size() - 1, of_address);
  if (*end != ',' || end - begin < 3) return {};
  std::copy(text_.begin(), end, name.begin());
  return name;
}

}  // namespace drivers
