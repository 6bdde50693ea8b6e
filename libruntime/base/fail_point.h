// SPDX-License-Identifier: LGPL-3.0-or-later
/// Points at which a test cuts the power, or holds the program up. Nothing at all unless
/// MAUVE_FAIL_POINTS is defined, which only test programs do.
#pragma once

#ifdef MAUVE_FAIL_POINTS

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

namespace mauve {

/// The action of a test in the same program at each point.
inline std::function<void(std::string_view)>& at_fail_point() {
  static std::function<void(std::string_view)> action;
  return action;
}

/// Ends the process with exit code 86, without any tidying, when the environment has
/// MAUVE_FAIL=NAME ("NAME@2": when the point is reached the second time). [any]
inline void fail_point(std::string_view name) {
  if (at_fail_point()) at_fail_point()(name);
  static std::atomic<int> times{0};
  const char* wanted = std::getenv("MAUVE_FAIL");
  const std::string_view text = wanted == nullptr ? std::string_view() : wanted;
  if (text.substr(0, text.find('@')) != name) return;
  const auto at = text.find('@');
  const int count = at == std::string_view::npos ? 1 : std::atoi(wanted + at + 1);
  if (++times == count) _exit(86);
}

}  // namespace mauve

#define MAUVE_FAIL_POINT(name) ::mauve::fail_point(name)
#else
#define MAUVE_FAIL_POINT(name) static_cast<void>(0)
#endif
