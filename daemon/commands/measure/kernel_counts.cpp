// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/measure/kernel_counts.h"

#include <algorithm>

namespace mauve::daemon {

protocol::Json kernel_counts(const std::vector<rt::ThreadFacts>& threads,
                             const std::string& component) {
  constexpr std::size_t kKernelName = 15;
  const auto name = component.substr(0, kKernelName);
  const auto is_its = [&](const rt::ThreadFacts& thread) { return thread.name == name; };
  if (std::ranges::count_if(threads, is_its) != 1) {
    return nullptr;
  }
  const auto& thread = *std::ranges::find_if(threads, is_its);
  return {{"minor_faults", thread.minor_faults},
          {"major_faults", thread.major_faults},
          {"waits", thread.waits},
          {"preemptions", thread.preemptions}};
}

}  // namespace mauve::daemon
