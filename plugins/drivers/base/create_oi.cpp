// SPDX-License-Identifier: LGPL-3.0-or-later
#include "create_oi.h"

#include <algorithm>

namespace drivers::create {
namespace {

constexpr std::uint8_t kHeader = 19;
constexpr std::uint8_t kContacts = 7;
constexpr std::uint8_t kMode = 35;
constexpr std::uint8_t kLeft = 43;
constexpr std::uint8_t kRight = 44;
/// A frame of ours before its data are filled in.
constexpr std::array<std::uint8_t, kFrame> kLayout{kHeader, 10, kContacts, 0, kMode, 0, kLeft,
                                                   0,       0,  kRight,    0, 0,     0};

/// Bytes of the single packets 7 to 58.
constexpr std::uint8_t kFirstPacket = 7;
constexpr std::array<std::uint8_t, 52> kSizes{1, 1, 1, 1, 1, 1, 1, 1, 1, 1,     // 7 to 16
                                              1, 1, 2, 2, 1, 2, 2, 1, 2, 2,     // 17 to 26
                                              2, 2, 2, 2, 2, 1, 2, 1,           // 27 to 34
                                              1, 1, 1, 1, 2, 2, 2, 2,           // 35 to 42
                                              2, 2, 1, 2, 2, 2, 2, 2, 2, 1, 1,  // 43 to 53
                                              2, 2, 2, 2, 1};                   // 54 to 58

/// Single packets that a packet consists of; `last` 0: its number is not known here.
struct Range {
  std::uint8_t first = 0;
  std::uint8_t last = 0;
};

constexpr Range range_of(std::uint8_t number) {
  if (number >= kFirstPacket && number < kFirstPacket + kSizes.size()) return {number, number};
  switch (number) {
    case 0:
      return {7, 26};
    case 1:
      return {7, 16};
    case 2:
      return {17, 20};
    case 3:
      return {21, 26};
    case 4:
      return {27, 34};
    case 5:
      return {35, 42};
    case 6:
      return {7, 42};
    case 100:
      return {7, 58};
    case 101:
      return {43, 58};
    case 106:
      return {46, 51};
    case 107:
      return {54, 58};
    default:
      return {};
  }
}

constexpr std::uint8_t high(unsigned number) { return static_cast<std::uint8_t>(number >> 8U); }
constexpr std::uint8_t low(unsigned number) { return static_cast<std::uint8_t>(number & 0xffU); }
constexpr std::uint16_t word(std::uint8_t high_byte, std::uint8_t low_byte) {
  return static_cast<std::uint16_t>((high_byte << 8U) | low_byte);
}
constexpr int speed(std::uint8_t high_byte, std::uint8_t low_byte) {
  return static_cast<std::int16_t>(word(high_byte, low_byte));
}

/// Fills in a single packet of ours and ticks it off.
void take(std::uint8_t number, std::span<const std::uint8_t> data, Report& report,
          std::array<bool, 4>& met) {
  switch (number) {
    case kContacts:
      report.contacts = data[0];
      met[0] = true;
      break;
    case kMode:
      report.mode = static_cast<Mode>(data[0]);
      met[1] = true;
      break;
    case kLeft:
      report.left = word(data[0], data[1]);
      met[2] = true;
      break;
    case kRight:
      report.right = word(data[0], data[1]);
      met[3] = true;
      break;
    default:
      break;
  }
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

std::optional<Packets> read_packets(std::span<const std::uint8_t> data) {
  constexpr std::array<std::uint8_t, 4> kOurs{kContacts, kMode, kLeft, kRight};
  Packets packets;
  std::array<bool, kOurs.size()> met{};
  while (!data.empty() && packets.unknown == 0) {
    const Range range = range_of(data[0]);
    if (range.last == 0) {
      packets.unknown = data[0];
      break;
    }
    data = data.subspan(1);
    for (std::uint8_t number = range.first; number <= range.last; ++number) {
      const std::size_t size = kSizes[number - kFirstPacket];
      if (size > data.size()) return {};
      take(number, data.first(size), packets.report, met);
      data = data.subspan(size);
    }
  }
  const auto missed = std::find(met.begin(), met.end(), false);
  if (missed != met.end()) packets.lacks = kOurs[static_cast<std::size_t>(missed - met.begin())];
  return packets;
}

ReportReader::Event ReportReader::next() {
  if (const auto begin = complete()) {
    if (drop(*begin)) return Event::bad;  // the next call finds the frame again
    skipped_ = 0;
    if (packets_.lacks != 0) {
      // The end of a frame and the begin of the next may look like one for as long as the base
      // stands: only the header is dropped.
      excused_ = size_;
      drop(1);
      return Event::lacking;
    }
    size_ = excused_ = 0;
    report_ = packets_.report;
    return Event::report;
  }
  std::size_t begin = 0;
  while (begin < size_ && !possible(begin)) ++begin;
  return drop(begin) ? Event::bad : Event::none;
}

/// Where the undamaged frame begins that the last byte completes. One that does not begin with the
/// bytes that wait has to have all of our packets.
std::optional<std::size_t> ReportReader::complete() {
  for (std::size_t begin = 0; begin + kAround < size_; ++begin) {
    const auto frame = std::span(bytes_).subspan(begin, size_ - begin);
    if (frame[0] != kHeader || frame[1] + kAround != frame.size()) continue;
    if (checksum(frame.first(frame.size() - 1)) != frame.back()) continue;
    const auto packets = read_packets(frame.subspan(2, frame[1]));
    if (!packets || (begin > 0 && packets->lacks != 0)) continue;
    packets_ = *packets;
    length_ = std::max(frame.size(), kFrame);
    return begin;
  }
  return {};
}

/// A frame may begin here, and is not complete yet.
bool ReportReader::possible(std::size_t begin) const {
  const std::size_t size = size_ - begin;
  if (bytes_[begin] != kHeader) return false;
  if (size == 1) return true;
  const std::size_t data = bytes_[begin + 1];
  return data > 1 && data <= kMostData && size < data + kAround;
}

/// Drops the first bytes, up to the next one that is to be counted: one for as many as a frame has.
/// True when that one was dropped.
bool ReportReader::drop(std::size_t count) {
  const std::size_t excused = std::min(count, excused_);
  const std::size_t uncounted = excused + (length_ - skipped_ % length_) % length_;
  const bool counts = count > uncounted;
  if (counts) count = uncounted + 1;
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(count),
            bytes_.begin() + static_cast<std::ptrdiff_t>(size_), bytes_.begin());
  size_ -= count;
  skipped_ += count - excused;
  excused_ -= excused;
  return counts;
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
