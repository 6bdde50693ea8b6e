// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/late_summary.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>

namespace mauve::daemon {

namespace {

constexpr std::string_view kMissed = "missed";
constexpr std::string_view kOverrun = "overrun";

/// "3 releases missed, 9 in all": one runtime event may report several releases.
std::int64_t number_in(const RuntimeEvent& happening) {
  std::int64_t number = 1;
  if (happening.event == kMissed) {
    const auto& text = happening.text;
    std::from_chars(text.data(), text.data() + text.size(), number);
  }
  return number;
}

}  // namespace

bool LateSummary::concerns(const RuntimeEvent& happening) {
  return happening.event == kMissed || happening.event == kOverrun;
}

bool LateSummary::pass(const RuntimeEvent& happening) {
  if (happening.long_job) {
    explained_ = std::max(explained_, happening.time);
  }
  auto found = std::find_if(all_.begin(), all_.end(), [&](const Counted& one) {
    return one.last.component == happening.component && one.last.event == happening.event;
  });
  if (found == all_.end()) {
    all_.push_back({happening, happening.time, 0});
    return true;
  }
  found->last = happening;
  if (found->more == 0 && happening.time - found->since >= kEach.count()) {
    found->since = happening.time;
    return true;
  }
  found->more += number_in(happening);
  return false;
}

std::vector<RuntimeEvent> LateSummary::due(Instant now) {
  std::vector<RuntimeEvent> lines;
  for (auto& one : all_) {
    if (one.more > 0 && now - one.since >= kEach.count()) {
      lines.push_back(summary(one, now));
    }
  }
  return lines;
}

std::vector<RuntimeEvent> LateSummary::finish(const std::string& component, Instant now) {
  std::vector<RuntimeEvent> lines;
  for (auto& one : all_) {
    if (one.more > 0 && one.last.component == component) {
      lines.push_back(summary(one, now));
    }
  }
  return lines;
}

std::size_t LateSummary::missed_together() {
  Instant newest = 0;
  for (const auto& one : all_) {
    newest = one.last.event == kMissed ? std::max(newest, one.last.time) : newest;
  }
  const auto count = std::count_if(all_.begin(), all_.end(), [&](const Counted& one) {
    return one.last.event == kMissed && newest - one.last.time <= kTogether.count();
  });
  const bool reported = together_ != 0 && newest - together_ < kEach.count();
  const bool explained = newest - explained_ <= kExplained.count();
  if (reported || explained || count < static_cast<std::ptrdiff_t>(kSeveral)) {
    return 0;
  }
  together_ = newest;
  return static_cast<std::size_t>(count);
}

/// "12 more releases missed in 10 s, 40 in all"
RuntimeEvent LateSummary::summary(Counted& counted, Instant now) {
  RuntimeEvent line = counted.last;
  line.time = now;
  const bool one = counted.more == 1;
  const auto* const missed = one ? " more release missed" : " more releases missed";
  const auto* const late = one ? " more job ended late" : " more jobs ended late";
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(Duration{now - counted.since});
  const auto comma = line.text.find(", ");
  line.text = std::to_string(counted.more) + (line.event == kMissed ? missed : late) + " in " +
              std::to_string(seconds.count()) + " s" +
              (comma == std::string::npos ? std::string() : line.text.substr(comma));
  counted.more = 0;
  counted.since = now;
  return line;
}

}  // namespace mauve::daemon
