// SPDX-License-Identifier: LGPL-3.0-or-later
/// Prints when which states of the gripper run, as the trace of the runtime records it.
#include <cstdio>
#include <string>

#include "gripping.h"

int main() {
  mauve::set_trace_mode(mauve::TraceMode::jobs);
  Gripping gripping;
  if (!gripping.deploy()) return 1;
  gripping.run(500ms);
  gripping.deployer().drain_trace([](const mauve::TraceRecord& record) {
    const std::string name(mauve::trace_name(record.name));
    switch (record.kind) {
      case mauve::TraceKind::release:
        return static_cast<void>(
            std::printf("%4lld ms:", static_cast<long long>(record.time / 1'000'000)));
      case mauve::TraceKind::begin:
        return static_cast<void>(std::printf(" %s", name.c_str()));
      case mauve::TraceKind::wait:
        return static_cast<void>(std::printf(", wait %s\n", name.c_str()));
      default:
        return;
    }
  });
}
