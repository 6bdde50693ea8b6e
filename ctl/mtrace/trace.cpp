// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/trace.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace mauve::ctl::mtrace {
namespace {

// In the order of Event.
constexpr EventWords kEvents[] = {
    {"", "instant_ns", "change"},       // release
    {"state", "", ""},                  // begin
    {"state", "preempted", ""},         // end
    {"state", "next_ns", "preempted"},  // wait
    {"resource", "waited_ns", ""},      // lock
    {"resource", "held_ns", ""},        // unlock
    {"resource", "waited_ns", ""},      // timeout
    {"port", "status", "took_ns"},      // call
    {"name", "", "value"},              // user
    {"", "late_ns", "overruns"},        // overrun
    {"", "used_ns", "budget_ns"},       // budget
    {"", "releases", "missed"},         // missed
    {"cause", "", ""},                  // fault
    {"", "first_ns", ""},               // started
    {"", "instant_ns", ""},             // stopped
    {"kind", "instant_ns", "change"},   // applied
    {"", "", "change"},                 // given_back
    {"what", "instant_ns", "change"},   // prepare
    {"what", "instant_ns", "change"},   // commit
    {"what", "instant_ns", "change"},   // abort
    {"what", "instant_ns", "change"},   // rollback
    {"component", "", "change"},        // member
    {"address", "", "change"},          // set
    {"", "held_up_ns", ""},             // disturbed
    {"", "records", ""},                // lost
};
static_assert(std::size(kEvents) == static_cast<std::size_t>(Event::lost) + 1);

}  // namespace

std::span<const EventWords> event_words() { return kEvents; }

const EventWords& words_of(Event event) { return kEvents[static_cast<std::size_t>(event)]; }

std::optional<Event> event_named(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kEvents); ++i) {
    if (to_string(static_cast<Event>(i)) == name) return static_cast<Event>(i);
  }
  return std::nullopt;
}

Word Trace::intern(std::string_view text) {
  const auto found = numbers_.find(text);
  if (found != numbers_.end()) return found->second;
  const auto number = static_cast<Word>(texts_.size());
  texts_.emplace_back(text);
  numbers_.emplace(text, number);
  return number;
}

std::optional<Word> Trace::find(std::string_view text) const {
  const auto found = numbers_.find(text);
  if (found == numbers_.end()) return std::nullopt;
  return found->second;
}

const Component* Trace::component(Word thread) const {
  const auto found = std::find_if(header.components.begin(), header.components.end(),
                                  [&](const Component& one) { return one.name == texts_[thread]; });
  return found == header.components.end() ? nullptr : &*found;
}

std::int64_t Trace::first_time() const {
  const auto first = std::min_element(records.begin(), records.end(),
                                      [](const auto& x, const auto& y) { return x.time < y.time; });
  return first == records.end() ? header.from : first->time;
}

std::int64_t Trace::last_time() const {
  const auto last = std::max_element(records.begin(), records.end(),
                                     [](const auto& x, const auto& y) { return x.time < y.time; });
  return last == records.end() ? header.to : last->time;
}

std::string instant_in_words(std::int64_t time) {
  const bool before = time < 0;
  const auto ns = before ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "T0 %c %llu.%09llu s", before ? '-' : '+',
                static_cast<unsigned long long>(ns / 1'000'000'000),
                static_cast<unsigned long long>(ns % 1'000'000'000));
  return text.data();
}

}  // namespace mauve::ctl::mtrace
