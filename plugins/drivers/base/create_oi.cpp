// SPDX-License-Identifier: LGPL-3.0-or-later
#include "create_oi.h"

#include <algorithm>

namespace drivers::create {
namespace {

constexpr std::uint8_t kHeader = 19;
/// A frame of ours before its data are filled in.
constexpr std::array<std::uint8_t, kFrame> kLayout{kHeader, 10, 7, 0, 35, 0, 43, 0, 0, 44, 0, 0, 0};
/// Where the layout must be met.
constexpr std::array<std::size_t, 6> kFixed{0, 1, 2, 4, 6, 9};

constexpr std::uint8_t high(unsigned number) { return static_cast<std::uint8_t>(number >> 8U); }
constexpr std::uint8_t low(unsigned number) { return static_cast<std::uint8_t>(number & 0xffU); }
constexpr std::uint16_t word(std::uint8_t high_byte, std::uint8_t low_byte) {
  return static_cast<std::uint16_t>((high_byte << 8U) | low_byte);
}
constexpr int speed(std::uint8_t high_byte, std::uint8_t low_byte) {
  return static_cast<std::int16_t>(word(high_byte, low_byte));
}

}  // namespace

std::uint8_t checksum(std::span<const std::uint8_t> before) {
  unsigned sum = 0;
  for (const std::uint8_t byte : before) sum += byte;
  return low(256U - low(sum));
}

Frame frame_of(const Report& report) {
  std::array<std::uint8_t, kFrame> bytes = kLayout;
  bytes[3] = report.contacts;
  bytes[5] = static_cast<std::uint8_t>(report.mode);
  bytes[7] = high(report.left);
  bytes[8] = low(report.left);
  bytes[10] = high(report.right);
  bytes[11] = low(report.right);
  bytes[12] = checksum(std::span(bytes).first(kFrame - 1));
  Frame frame{};
  std::transform(bytes.begin(), bytes.end(), frame.begin(),
                 [](std::uint8_t byte) { return static_cast<char>(byte); });
  return frame;
}

std::string_view begin_text() {
  static constexpr std::array<char, 8> kText{static_cast<char>(Opcode::start),
                                             static_cast<char>(Opcode::safe),
                                             static_cast<char>(Opcode::stream),
                                             4,
                                             7,
                                             35,
                                             43,
                                             44};
  return {kText.data(), kText.size()};
}

std::array<char, 5> drive_text(int left, int right) {
  const auto bytes = [](int speed_of_one) {
    return static_cast<unsigned>(std::clamp(speed_of_one, -500, 500)) & 0xffffU;
  };
  const unsigned first = bytes(right);
  const unsigned second = bytes(left);
  return {static_cast<char>(Opcode::drive_direct), static_cast<char>(high(first)),
          static_cast<char>(low(first)), static_cast<char>(high(second)),
          static_cast<char>(low(second))};
}

ReportReader::Event ReportReader::push(char byte) {
  bytes_[size_++] = static_cast<std::uint8_t>(byte);
  if (size_ == kFrame && good()) {
    report_ = {bytes_[3], static_cast<Mode>(bytes_[5]), word(bytes_[7], bytes_[8]),
               word(bytes_[10], bytes_[11])};
    size_ = 0;
    skipped_ = 0;
    return Event::report;
  }
  bool bad = false;
  if (size_ == kFrame) bad = skip();
  while (size_ > 0 && bytes_[0] != kHeader) bad = skip() || bad;
  return bad ? Event::bad : Event::none;
}

bool ReportReader::good() const {
  const bool ours = std::all_of(kFixed.begin(), kFixed.end(),
                                [this](std::size_t i) { return bytes_[i] == kLayout[i]; });
  return ours && checksum(std::span(bytes_).first(kFrame - 1)) == bytes_[kFrame - 1];
}

/// Drops the first byte. True when that is to be counted: once for as many bytes as a frame has.
bool ReportReader::skip() {
  std::copy(bytes_.begin() + 1, bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
            bytes_.begin());
  --size_;
  return skipped_++ % kFrame == 0;
}

std::optional<Command> CommandReader::push(char byte) {
  const auto number = static_cast<std::uint8_t>(byte);
  if (counts_) {
    counts_ = false;
    left_ = number;
  } else if (left_ > 0) {
    if (size_ < data_.size()) data_[size_++] = number;
    --left_;
  } else {
    size_ = 0;
    opcode_ = Opcode{number};
    counts_ = opcode_ == Opcode::stream;
    left_ = opcode_ == Opcode::drive_direct ? 4 : 0;
  }
  if (counts_ || left_ > 0) return {};
  switch (opcode_) {
    case Opcode::drive_direct:
      return Command{opcode_, speed(data_[2], data_[3]), speed(data_[0], data_[1])};
    case Opcode::start:
    case Opcode::safe:
    case Opcode::stream:
      return Command{opcode_, 0, 0};
  }
  return {};
}

}  // namespace drivers::create
