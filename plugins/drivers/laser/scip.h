// SPDX-License-Identifier: LGPL-3.0-or-later
/// SCIP 2.0, the protocol of Hokuyo's laser scanners: numbers, requests and replies, a byte at a
/// time. Source: Hokuyo, "Communication Protocol Specification for SCIP 2.0 Standard", C-42-03320B.
/// A reply is the echo of the request, a status, lines that each end in a checksum, an empty line.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "../../types/scan.h"

namespace drivers::scip {

/// Values in a scan of any scanner: as many as a LaserScan holds.
inline constexpr std::size_t kMostValues = rover::LaserScan::kCapacity;
/// Characters of data in a line.
inline constexpr std::size_t kBlock = 64;

/// The character that ends a line: six bits of the sum. [rt]
[[nodiscard]] char checksum(std::string_view text);
/// Writes a number, six bits in each character, high ones first. [rt]
void encode(std::uint32_t value, std::span<char> into);
/// The number in 2, 3 or 4 characters; nothing when one of them is out of range. [rt]
[[nodiscard]] std::optional<std::uint32_t> decode(std::string_view characters);

/// The limits that the scanner states in reply to PP.
struct Limits {
  int dmin = 0;  ///< mm; a smaller value is an error code, not a range
  int dmax = 0;  ///< mm
  int ares = 0;  ///< steps in a full turn
  int amin = 0;  ///< first step that measures
  int amax = 0;  ///< last step that measures
  int afrt = 0;  ///< step that looks ahead; steps count anticlockwise
  int scan = 0;  ///< turns in a minute

  /// Nothing is missing and it can be a scanner. [rt]
  [[nodiscard]] bool usable() const;
};

/// A request for scans without end: MD, or MS with two characters a value.
struct Request {
  int first = 0;
  int last = 0;
  int cluster = 1;     ///< steps that make one value, the smallest of them
  int characters = 3;  ///< of a value: 3 (18 bits) or 2 (12 bits)

  friend bool operator==(const Request&, const Request&) = default;

  /// Everything the scanner sees, in so large clusters that it fits a LaserScan. [rt]
  [[nodiscard]] static Request all(const Limits& limits, int characters);
  /// Values in each scan. [rt]
  [[nodiscard]] std::size_t values() const;
  /// "MD", first and last step, cluster, no turn left out, and how many scans are left (00: no
  /// end). [rt]
  [[nodiscard]] std::array<char, 15> text() const;
  /// From such a text, with any last two digits. [rt]
  [[nodiscard]] static std::optional<Request> parse(std::string_view text);
};

/// Values as metres with their directions; a value below DMIN becomes 0, which is no valid range.
/// [rt]
void show(const Request& request, const Limits& limits, std::span<const std::uint32_t> values,
          rover::LaserScan& scan);
/// Is every value an error code? [rt]
[[nodiscard]] bool blind(const Limits& limits, std::span<const std::uint32_t> values);

/// Collects a line in a bounded buffer.
class TextReader {
 public:
  /// A line of data is 65 long; the names in reply to VV and PP are longer.
  static constexpr std::size_t kLongest = 128;

  /// True at the end of a line: see line(), until the next push(). [rt]
  bool push(char byte);
  [[nodiscard]] std::string_view line() const { return {text_.data(), size_}; }
  /// The line, ended or not, has more than it may have. [rt]
  [[nodiscard]] bool too_long() const { return too_long_; }

 private:
  std::array<char, kLongest> text_{};
  std::size_t size_ = 0;
  bool too_long_ = false;
  bool ended_ = false;
};

/// Finds replies in a stream of bytes. A damaged one is counted once and nothing of it is used; the
/// next begins after an empty line. All of it is [rt].
class ReplyReader {
 public:
  enum class Event : std::uint8_t {
    none,   ///< go on
    reply,  ///< undamaged: see command() and status(), and limits() after PP
    scan,   ///< an undamaged scan, as it was asked for: see values()
    bad,    ///< damaged, or a scan that was not asked for
  };

  /// The form of the scans from now on.
  void expect(const Request& request) { request_ = request; }
  Event push(char byte);

  /// Two letters, such as "PP"; until the next push().
  [[nodiscard]] std::string_view command() const { return {echo_.data(), 2}; }
  /// Two characters: "00" is well.
  [[nodiscard]] std::string_view status() const { return {status_.data(), 2}; }
  [[nodiscard]] const Limits& limits() const { return limits_; }
  [[nodiscard]] const Request& request() const { return request_; }
  /// Millimetres and error codes of the last scan; until the next push().
  [[nodiscard]] std::span<const std::uint32_t> values() const { return {values_.data(), count_}; }
  /// Milliseconds on the scanner's clock, 24 bits.
  [[nodiscard]] std::uint32_t stamp() const { return stamp_; }

 private:
  enum class Place : std::uint8_t { echo, status, body, stamp, data, lost };

  Event end_line(std::string_view line);
  Event on_echo(std::string_view line);
  Event on_status(std::string_view line);
  Event on_body(std::string_view line);
  Event on_stamp(std::string_view line);
  Event on_data(std::string_view line);
  Event finish(bool complete, Event event);
  Event lose();
  bool take_limit(std::string_view field);

  TextReader lines_;
  Place place_ = Place::echo;
  bool counted_ = true;  // damage up to the next empty line is counted already, or is a beginning
  std::array<char, 16> echo_{};
  std::size_t echo_size_ = 0;
  std::array<char, 2> status_{};
  Limits limits_;
  unsigned limits_seen_ = 0;  // a bit for each field
  Request request_;
  std::uint32_t stamp_ = 0;
  std::array<std::uint32_t, kMostValues> values_{};
  std::size_t count_ = 0;
  std::uint32_t begun_ = 0;  // of the value that goes on in the next line
  int begun_size_ = 0;       // its characters so far
};

}  // namespace drivers::scip
