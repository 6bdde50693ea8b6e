// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finds NMEA 0183 sentences in a stream of bytes, a byte at a time: `$...*hh` and `!...*hh`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "proven.h"

namespace drivers {

/// Incremental reader. A sentence with the right checksum counts wherever it begins. Only a whole
/// line with a wrong checksum is damage, where GGA or an address of which two in a row were right
/// begins it. All else is skipped: binary, prose, logs, sentences without checksum. All of it is
/// [rt].
class FrameReader {
 public:
  /// Longest text between `$` and `*`. The standard allows 82 characters in all; makers exceed it.
  static constexpr std::size_t kLongest = 1024;

  enum class Event : std::uint8_t {
    none,   ///< go on
    frame,  ///< a sentence is complete and its checksum is right: see frame()
    bad,    ///< a sentence turned out to be damaged; it was counted
  };

  Event push(char byte);
  /// The rest of the sentence that has begun will not come.
  void drop_begun();

  /// Text between `$` and `*` of the last complete sentence, until the next push().
  [[nodiscard]] std::string_view frame() const { return {&text_[frame_], frame_size_}; }
  /// Inside a line that may be a sentence, and is not complete yet.
  [[nodiscard]] bool in_frame() const { return size_ > 0; }
  [[nodiscard]] std::uint32_t good() const { return good_; }
  [[nodiscard]] std::uint32_t bad() const { return bad_; }

 private:
  using Name = std::array<char, 16>;  // `$` and address; empty: none that can be

  /// A place in the text where a sentence may begin.
  struct Start {
    std::size_t place = 0;
    std::uint8_t sum = 0;   // XOR of all behind it
    std::uint8_t text = 0;  // and of that before the last `*`
  };

  void add(char byte, bool start);
  void make_room();
  void forget();
  Event look(char byte);
  Event complete(const Start& start);
  Event end_line();
  [[nodiscard]] Name name() const;

  // A sentence begins at the first `$` or `!` of its line, or at the last, after one that broke
  // off.
  std::array<char, kLongest + 4> text_{};  // of the line, from the first on
  std::size_t size_ = 0;
  Start first_;
  Start last_;
  std::size_t star_ = 0;     // place of the last `*`
  bool starred_ = false;     // only digits follow it
  std::uint8_t digits_ = 0;  // of these, at most 2
  std::uint8_t given_ = 0;   // the number that they are
  bool line_start_ = true;   // the next byte begins a line
  bool whole_ = false;       // the first `$` or `!` began the line
  Name sealed_{};            // of a sentence that is the whole line up to here

  std::size_t frame_ = 0;
  std::size_t frame_size_ = 0;
  Proven<Name, 32> proven_;
  std::uint32_t good_ = 0;
  std::uint32_t bad_ = 0;
};

}  // namespace drivers
