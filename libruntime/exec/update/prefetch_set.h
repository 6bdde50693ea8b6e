// SPDX-License-Identifier: LGPL-3.0-or-later
/// PrefetchSet: what a job is about to touch. A component that sleeps for milliseconds finds the
/// caches cold, and goes from port to connection to resource by pointers: each line would be waited
/// for in its turn. Asked for together when a job begins, they come in the time of one or two.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <mauve/component.h>

namespace mauve::exec {

/// Only addresses: what is gone meanwhile is not looked at, and asking for it harms nobody.
class PrefetchSet {
 public:
  explicit PrefetchSet(const Bundle& bundle);

  /// Waits for nothing. [rt]
  void ask() const {
    for (const std::uintptr_t line : lines_) {
      __builtin_prefetch(reinterpret_cast<const void*>(line));  // NOLINT: an address
    }
  }
  /// Where lines of the cache begin, each once.
  [[nodiscard]] const std::vector<std::uintptr_t>& lines() const { return lines_; }

 private:
  void add(const void* object, std::size_t size);
  void add(const Shell& shell, const Bindings& bindings);
  void add(const Exchange& exchange);

  std::vector<std::uintptr_t> lines_;
};

}  // namespace mauve::exec
