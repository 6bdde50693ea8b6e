// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finds NMEA 0183 sentences in a stream of bytes, a byte at a time: `$...*hh`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace drivers {

/// Incremental reader. Counts damaged sentences exactly once and never trusts a length: noise,
/// binary and prose between sentences are skipped. All of it is [rt].
class FrameReader {
 public:
  /// Longest text between `$` and `*`. The standard allows 82 characters in all; real receivers
  /// exceed it (SkyTraq sends 100).
  static constexpr std::size_t kLongest = 160;

  enum class Event : std::uint8_t {
    none,   ///< go on
    frame,  ///< a sentence is complete and its checksum is right: see frame()
    bad,    ///< a sentence turned out to be damaged; it was counted
  };

  Event push(char byte);
  /// The rest of the sentence that has begun will not come: it is damaged.
  Event drop_begun() { return in_frame() ? refuse() : Event::none; }

  /// Text between `$` and `*` of the last complete sentence, until the next push().
  [[nodiscard]] std::string_view frame() const { return {text_.data(), size_}; }
  /// Inside a sentence that is not complete yet.
  [[nodiscard]] bool in_frame() const { return place_ != Place::between; }
  [[nodiscard]] std::uint32_t good() const { return good_; }
  [[nodiscard]] std::uint32_t bad() const { return bad_; }

 private:
  enum class Place : std::uint8_t { between, text, checksum };

  Event start();
  Event in_text(char byte);
  Event in_checksum(char byte);
  Event in_between(char byte);
  Event refuse();
  [[nodiscard]] bool in_address() const { return address_; }

  std::array<char, kLongest> text_{};
  std::size_t size_ = 0;
  Place place_ = Place::between;
  bool address_ = false;       // before the first comma
  bool line_counted_ = false;  // a damaged sentence of this line was counted already
  std::uint8_t sum_ = 0;       // XOR of the text
  std::uint8_t given_ = 0;     // checksum as sent
  std::uint8_t digits_ = 0;    // of the checksum
  std::uint8_t tail_ = 0;      // how much of `*hh` the skipped bytes end with
  std::uint32_t good_ = 0;
  std::uint32_t bad_ = 0;
};

}  // namespace drivers
