// SPDX-License-Identifier: LGPL-3.0-or-later
/// A process of its own for one measurement: an allocator and a cache of stacks that were used
/// before would flatter it.
#pragma once

#include <array>
#include <cstdlib>
#include <functional>
#include <type_traits>

#include <sys/wait.h>
#include <unistd.h>

namespace bench {

/// Call it before this process has threads.
template <typename Result>
Result in_child(const std::function<Result()>& body) {
  static_assert(std::is_trivially_copyable_v<Result>, "it comes through a pipe");
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) std::exit(1);
  const pid_t child = fork();
  if (child == 0) {
    const Result result = body();
    const bool sent = write(ends[1], &result, sizeof result) == sizeof result;
    _exit(sent ? 0 : 1);
  }
  Result result{};
  close(ends[1]);
  if (read(ends[0], &result, sizeof result) != sizeof result) std::exit(1);
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return result;
}

}  // namespace bench
