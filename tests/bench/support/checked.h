// SPDX-License-Identifier: LGPL-3.0-or-later
/// A benchmark whose system is refused has nothing to measure: it says why and ends.
#pragma once

#include <cstdlib>
#include <iostream>
#include <utility>

#include <mauve/result.h>

namespace bench {

inline void must(const mauve::Status& done) {
  if (done) return;
  std::cerr << mauve::to_string(done.error()) << "\n";
  std::exit(1);
}

/// A condition without which a benchmark measures nothing.
inline void must_hold(bool condition, const char* what) {
  if (condition) return;
  std::cerr << "this measures nothing: " << what << "\n";
  std::exit(1);
}

template <typename T>
T checked(mauve::Result<T> result) {
  if (result) return *std::move(result);
  std::cerr << mauve::to_string(result.error()) << "\n";
  std::exit(1);
}

}  // namespace bench
