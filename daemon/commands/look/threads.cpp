// SPDX-License-Identifier: LGPL-3.0-or-later
/// daemon.threads: the threads of mauved, and how much each uses the processors.
#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>
#include <tuple>

#include "commands/command.h"
#include "rt/process/process.h"

namespace mauve::daemon {

namespace {

/// Both null where the kernel does not count these times.
struct ProcessorTimes {
  Json ran;
  Json ready;
};

/// A file such as /proc/self/task/42/schedstat: two times in nanoseconds, and a count.
ProcessorTimes processor_times(int thread) {
  const auto text =
      rt::file_text("/proc/self/task/" + std::to_string(thread) + "/schedstat").value_or("");
  std::istringstream stream(text);
  std::int64_t ran = 0;
  std::int64_t ready = 0;
  if (!(stream >> ran >> ready)) {
    return {};
  }
  return {ran, ready};
}

Json thread_json(const rt::ThreadFacts& thread) {
  auto times = processor_times(thread.id);
  return {{"name", thread.name},
          {"policy", thread.policy},
          {"priority", thread.priority},
          {"cpu", thread.cpu},
          {"ran_ns", std::move(times.ran)},
          {"ready_ns", std::move(times.ready)},
          {"waits", thread.waits},
          {"preemptions", thread.preemptions},
          {"minor_faults", thread.minor_faults},
          {"major_faults", thread.major_faults},
          {"id", thread.id}};
}

}  // namespace

Result<Json> list_threads(Running& /*running*/, const Call& /*call*/) {
  auto threads = rt::threads_of("/", "self");
  std::ranges::stable_sort(threads, [](const rt::ThreadFacts& a, const rt::ThreadFacts& b) {
    return std::tuple(!a.urgent(), -a.priority) < std::tuple(!b.urgent(), -b.priority);
  });
  Json rows = Json::array();
  for (const auto& thread : threads) {
    rows.push_back(thread_json(thread));
  }
  return Json{{"items", std::move(rows)}};
}

}  // namespace mauve::daemon
