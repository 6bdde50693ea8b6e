// SPDX-License-Identifier: LGPL-3.0-or-later
/// PrefetchSet: the memory that a job is about to touch. A component that sleeps for milliseconds
/// finds the caches cold, and goes from port to connection to resource by pointers: each line would
/// be waited for in its turn. Requested together when a job begins, all lines come in the time of
/// one or two.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <mauve/host/component.h>

namespace mauve::exec {

/// Only addresses: an object that is gone meanwhile is not read, and a prefetch of its address does
/// no harm.
class PrefetchSet {
 public:
  explicit PrefetchSet(const Bundle& bundle);

  /// Requests the lines; does not wait. [rt]
  void prefetch() const {
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
