// SPDX-License-Identifier: LGPL-3.0-or-later
/// Waiting for a condition, with a bound that only a broken program reaches.
#pragma once

#include <chrono>
#include <thread>

namespace mauve::test {

/// Bound of an orderly end that is expected to succeed. A component may take a quarter of it to
/// reach its boundary, also on a machine that stands still meanwhile.
inline constexpr std::chrono::seconds kPatience{20};

/// True as soon as `condition()` is; false when it was not within `limit`. A disk may stand still
/// for 10 s beside a build, and a start is confirmed after 10 s.
template <typename Condition>
[[nodiscard]] bool eventually(Condition condition,
                              std::chrono::milliseconds limit = std::chrono::minutes(1)) {
  const auto until = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// The refusal of a change that some member holds up. A busy machine may delay an attempt
/// beyond its instant: that changes nothing, and is refused for this reason instead. So it is made
/// again until its refusal is the `expected` one.
template <typename Apply, typename Expected>
[[nodiscard]] auto refused_for(Apply apply, Expected expected) {
  auto answer = apply();
  static_cast<void>(eventually([&] {
    if (answer || expected(answer.error())) return true;
    answer = apply();
    return false;
  }));
  return answer;
}

}  // namespace mauve::test
