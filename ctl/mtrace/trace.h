// SPDX-License-Identifier: LGPL-3.0-or-later
/// A trace in memory: the jobs that ran, and events with their times. Times are ns since T0.
#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/trace.h"

namespace mauve::ctl::mtrace {

using Event = TraceKind;

/// The meaning of the name and the numbers of an event; empty: it has none.
struct EventWords {
  std::string_view name;
  std::string_view a;
  std::string_view b;
};
/// By the number of the event.
[[nodiscard]] std::span<const EventWords> event_words();
[[nodiscard]] const EventWords& words_of(Event event);
[[nodiscard]] std::optional<Event> event_named(std::string_view name);

/// Threads that are no component.
inline constexpr std::string_view kControl = "[control]";
inline constexpr std::string_view kProbe = "[probe]";
/// In place of the instant of a change that has none.
inline constexpr std::int64_t kNoInstant = -1;

using Word = std::uint32_t;  ///< a text of the trace

struct Record {
  std::int64_t time = 0;
  std::int64_t a = 0;
  std::int64_t b = 0;  ///< of `user` the bits of a double
  Word thread = 0;
  Word name = 0;
  std::uint32_t line = 0;  ///< of the file, counted from 1; 0: it was in none
  Event event = Event::release;

  [[nodiscard]] double value() const { return std::bit_cast<double>(b); }
};

using State = protocol::TraceState;
using Component = protocol::TraceComponent;
using Header = protocol::TraceHeader;

/// How much of a file was sound.
struct Reading {
  bool complete = false;           ///< its last line is there
  std::uint64_t unknown = 0;       ///< records of an event that this version does not know
  std::uint64_t broken = 0;        ///< lines that are no record
  std::uint64_t first_broken = 0;  ///< the number of the first
  std::string first_reason;
};

class Trace {
 public:
  Header header;
  std::vector<Record> records;  ///< of one thread in the order in which it happened
  Reading reading;

  Word intern(std::string_view text);
  /// The number of a text that occurs, else nothing.
  [[nodiscard]] std::optional<Word> find(std::string_view text) const;
  [[nodiscard]] const std::string& text(Word word) const { return texts_[word]; }
  [[nodiscard]] std::size_t words() const { return texts_.size(); }
  /// Null for threads that are no component of the header.
  [[nodiscard]] const Component* component(Word thread) const;
  /// The times of the first and the last record, not those of the header.
  [[nodiscard]] std::int64_t first_time() const;
  [[nodiscard]] std::int64_t last_time() const;

 private:
  std::vector<std::string> texts_;
  std::map<std::string, Word, std::less<>> numbers_;
};

/// "T0 + 1.234567890 s", "T0 - 0.000001000 s".
[[nodiscard]] std::string instant_in_words(std::int64_t time);

}  // namespace mauve::ctl::mtrace
