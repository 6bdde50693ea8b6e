// SPDX-License-Identifier: LGPL-3.0-or-later
/// The Open Interface of iRobot's Create 2: commands to the base and the stream of its sensors, a
/// byte at a time. Source: iRobot, "Create 2 Open Interface Specification based on the Roomba 600".
/// A frame of the stream is 19, how many bytes follow, packets (number, data), and a byte that
/// makes the sum of them all 0 modulo 256.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace drivers::create {

/// The commands used here.
enum class Opcode : std::uint8_t {
  start = 128,         ///< listen; the wheels stop
  safe = 131,          ///< obey, until a wheel drops or a cliff is there
  drive_direct = 145,  ///< right, then left wheel, mm/s, two bytes each, high one first
  stream = 148,        ///< how many packets, then their numbers: every 15 ms
};

/// How the base takes commands. A number above these is a mode that is not known here.
enum class Mode : std::uint8_t { off, passive, safe, full };

/// Seconds between two frames of the stream.
inline constexpr double kStreamPeriod = 0.015;

/// The content of a frame of our stream: packets 7, 35, 43 and 44.
struct Report {
  std::uint8_t contacts = 0;  ///< bits: bump right, bump left, wheel dropped right, left
  Mode mode = Mode::off;
  std::uint16_t left = 0;  ///< encoder counts; they wrap
  std::uint16_t right = 0;

  [[nodiscard]] bool bumped() const { return (contacts & 0x3U) != 0; }
  [[nodiscard]] bool wheel_dropped() const { return (contacts & 0xcU) != 0; }
  [[nodiscard]] bool obeys() const { return mode == Mode::safe || mode == Mode::full; }
  friend bool operator==(const Report&, const Report&) = default;
};

/// Bytes of one such frame.
inline constexpr std::size_t kFrame = 13;
/// Bytes of packets in a frame, at most: what 115,200 baud carries in a period of the stream.
inline constexpr std::size_t kMostData = 169;
using Frame = std::array<char, kFrame>;

/// The byte that ends a frame. [rt]
[[nodiscard]] std::uint8_t checksum(std::span<const std::uint8_t> before);
/// As the base sends it. [rt]
[[nodiscard]] Frame frame_of(const Report& report);
/// Makes the base listen, obey and stream. [rt]
[[nodiscard]] std::string_view begin_text();
/// Drive Direct, mm/s; the base takes -500 to 500. [rt]
[[nodiscard]] std::array<char, 5> drive_text(int left, int right);

/// The content of a frame. Other packets than ours may stand between them, in any order. A
/// packet whose number is not known here has no known length, so nothing behind it is read.
struct Packets {
  Report report;
  std::uint8_t lacks = 0;    ///< number of the first of ours that was not met; 0: none
  std::uint8_t unknown = 0;  ///< number of the packet that is not known here; 0: none
};

/// Nothing: the known packets do not fill these bytes exactly. [rt]
[[nodiscard]] std::optional<Packets> read_packets(std::span<const std::uint8_t> data);

/// Finds frames in a stream of bytes. After a damaged one it looks on at the next byte. A frame
/// with all of our packets is found at once wherever it begins, so that a length or a 19 among the
/// data never hides it. All of it is [rt].
class ReportReader {
 public:
  enum class Event : std::uint8_t {
    none,     ///< all is looked at: push() the next byte
    report,   ///< an undamaged frame: see report()
    lacking,  ///< an undamaged frame without one of our packets: see packets()
    bad,      ///< as many bytes as a frame has were no frame, or fewer before the next good one
  };

  /// Only after next() returned `none`.
  void push(char byte) { bytes_[size_++] = static_cast<std::uint8_t>(byte); }
  Event next();
  [[nodiscard]] const Report& report() const { return report_; }
  /// Of the last undamaged frame.
  [[nodiscard]] const Packets& packets() const { return packets_; }

 private:
  static constexpr std::size_t kAround = 3;  // header, length, checksum
  static constexpr std::size_t kLongest = kMostData + kAround;

  std::optional<std::size_t> complete();
  [[nodiscard]] bool possible(std::size_t begin) const;
  bool drop(std::size_t count);

  std::array<std::uint8_t, kLongest> bytes_{};
  std::size_t size_ = 0;
  std::size_t length_ = kFrame;  // of the last good frame
  std::size_t skipped_ = 1;      // bytes since that one; the first few are a beginning
  std::size_t excused_ = 0;      // of the bytes that wait, those of a frame that lacks a packet
  Report report_;
  Packets packets_;
};

/// A command as the base hears it.
struct Command {
  Opcode opcode = Opcode::start;
  int left = 0;  ///< mm/s, of Drive Direct
  int right = 0;
};

/// Finds commands in a stream of bytes, for the simulated base. Unknown opcodes are skipped. All of
/// it is [rt].
class CommandReader {
 public:
  std::optional<Command> push(char byte);

 private:
  std::array<std::uint8_t, 4> data_{};
  std::size_t size_ = 0;
  std::size_t left_ = 0;  // data bytes still to come
  Opcode opcode_ = Opcode::start;
  bool counts_ = false;  // the next byte is their number
};

}  // namespace drivers::create
