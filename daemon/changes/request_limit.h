// SPDX-License-Identifier: LGPL-3.0-or-later
/// How often a component may ask for a transaction: its code may do so in every job.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "mauve/time.h"

namespace mauve::daemon {

/// So many at once, then one each `kEach`. [log]
class RequestLimit {
 public:
  static constexpr unsigned kAtOnce = 10;
  static constexpr Duration kEach{1s};

  /// False: it is not looked at. Times of one component never go back.
  [[nodiscard]] bool pass(std::string_view component, Instant now) {
    auto asked = asked_.find(component);
    if (asked == asked_.end()) {
      asked = asked_.emplace(component, Asked{now - kAtOnce * kEach.count(), 0}).first;
    }
    auto& [paid_until, ignored] = asked->second;
    const auto oldest = now - kAtOnce * kEach.count();
    paid_until = std::max(paid_until, oldest);
    if (paid_until + kEach.count() > now) {
      ++ignored;
      return false;
    }
    paid_until += kEach.count();
    return true;
  }
  /// Of this component, so far.
  [[nodiscard]] std::uint64_t ignored(std::string_view component) const {
    const auto asked = asked_.find(component);
    return asked == asked_.end() ? 0 : asked->second.ignored;
  }

 private:
  struct Asked {
    Instant paid_until;  ///< each request that passes pays for `kEach`
    std::uint64_t ignored;
  };

  std::map<std::string, Asked, std::less<>> asked_;
};

}  // namespace mauve::daemon
