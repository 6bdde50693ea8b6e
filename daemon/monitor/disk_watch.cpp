// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/disk_watch.h"

#include "base/duration.h"

namespace mauve::daemon {

namespace {

std::string in_milliseconds(Duration lasted) {
  return format_duration(std::chrono::round<std::chrono::milliseconds>(lasted));
}

}  // namespace

void DiskWatch::look(std::optional<Instant> busy_since, Instant now, const std::string& directory,
                     logging::Log& log) {
  if (slow_since_ && busy_since != slow_since_) {
    log.write(logging::Event::disk_answers,
              {{"directory", directory}, {"lasted", in_milliseconds(now - *slow_since_)}});
    slow_since_.reset();
  }
  if (busy_since && !slow_since_ && now - *busy_since >= kSlow) {
    slow_since_ = busy_since;
    log.write(logging::Event::disk_silent,
              {{"directory", directory}, {"lasted", in_milliseconds(now - *busy_since)}});
  }
}

Duration DiskWatch::silent_for(Instant now) const {
  return slow_since_ ? now - *slow_since_ : Duration{0};
}

}  // namespace mauve::daemon
