// SPDX-License-Identifier: LGPL-3.0-or-later
/// Releases that were lost, as counted in a trace that is read in slices while it is recorded.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "mtrace/findings.h"

namespace mauve::test {

/// One component was too late for this many releases in succession.
struct LostReleases {
  std::string component;
  std::int64_t from = 0;  ///< release of its last job before, ns since T0
  std::int64_t time = 0;  ///< the moment in which it noticed
  std::int64_t count = 0;
  bool disturbed = false;  ///< a probe was late meanwhile: the machine itself stood still
};

/// Finds each loss once in slices that overlap. Releases that a change lets pass by design (a
/// barrier, a swap in place) are marked "planned" in a trace and are not lost.
class LossWitness {
 public:
  /// The losses of a slice that no slice before contained. Records of the last moment of a slice
  /// may still be missing, so this moment belongs to the next slice.
  std::vector<LostReleases> look(const ctl::mtrace::Trace& slice) {
    using ctl::mtrace::Event;
    const std::int64_t end = slice.last_time() - kUnreported;
    gaps_ += until_ != kNever && slice.header.from > until_ ? 1 : 0;
    const ctl::mtrace::Windows disturbed = disturbed_windows(slice);
    std::vector<LostReleases> found;
    std::map<ctl::mtrace::Word, std::int64_t> released;  // the last job of each thread
    for (const ctl::mtrace::Record& record : slice.records) {
      if (record.event == Event::release) released[record.thread] = record.a;
      if (record.event == Event::release && record.time >= until_ && record.time < end) ++releases_;
      const bool missed = record.event == Event::missed && slice.text(record.name).empty();
      if (!missed || record.time < until_ || record.time >= end) continue;
      const auto job = released.find(record.thread);
      const std::int64_t from = job != released.end() ? job->second : record.time;
      found.push_back({slice.text(record.thread), from, record.time, record.a,
                       disturbed.touch(from, record.time)});
    }
    until_ = end;
    return found;
  }
  /// Slices that began after the end of the one before.
  [[nodiscard]] int gaps() const { return gaps_; }
  /// All releases that were looked at.
  [[nodiscard]] std::uint64_t releases() const { return releases_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  static constexpr std::int64_t kUnreported = 500'000'000;
  static constexpr std::int64_t kAround = 1'000'000;

  static ctl::mtrace::Windows disturbed_windows(const ctl::mtrace::Trace& slice) {
    ctl::mtrace::Windows windows;
    for (const ctl::mtrace::Record& record : slice.records) {
      if (record.event != ctl::mtrace::Event::disturbed) continue;
      windows.add(record.time - record.a - kAround, record.time + kAround);
    }
    windows.sort();
    return windows;
  }

  std::int64_t until_ = kNever;
  int gaps_ = 0;
  std::uint64_t releases_ = 0;
};

}  // namespace mauve::test
