// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which counts are worth a line of the log: the 1st, 10th, 100th, ...
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace mauve::daemon {

/// Counts by name. The owner of a name may be another one meanwhile, which counts anew: its count
/// is lower than at the last question, or its `epoch` differs.
class Milestones {
 public:
  /// Whether the count has reached another power of ten since the last question.
  [[nodiscard]] bool reached(const std::string& name, std::uint64_t count,
                             std::uint64_t epoch = 0) {
    auto& asked = asked_[name];
    if (count < asked.count || epoch != asked.epoch) {
      asked = {0, epoch, 1};
    }
    asked.count = count;
    if (count < asked.next) {
      return false;
    }
    while (asked.next <= count) {
      asked.next *= 10;
    }
    return true;
  }

 private:
  struct Asked {
    std::uint64_t count = 0;
    std::uint64_t epoch = 0;
    std::uint64_t next = 1;  ///< the power of ten that is reported next
  };
  std::map<std::string, Asked> asked_;
};

}  // namespace mauve::daemon
