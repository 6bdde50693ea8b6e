// SPDX-License-Identifier: LGPL-3.0-or-later
// An architecture of the sample plugin that uses everything, and pieces to damage it.
#pragma once

#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace sample {

inline constexpr std::string_view kArchitecture = R"({
  "schema": "mauve/architecture/1",
  "name": "sample",
  "plugins": ["sample"],
  "resources": {
    "pose":  { "type": "shared_data", "data": "pose/1" },
    "scan":  { "type": "ring_buffer", "data": "scan/1", "properties": { "core.capacity": 16 } },
    "relay": { "type": "sample/relay", "properties": { "interface.strict": true },
               "ports": { "next": "pose.write" }, "lock_budget": "50us" }
  },
  "components": {
    "left":  { "type": "sample/control",
               "properties": { "core.gain": 0.5, "fsm.period": "25ms", "shell.device": "/dev/left",
                               "core.home": { "x": 1, "y": 2.5 } },
               "ports": { "pose": { "connect": "pose.read", "max_age": "50ms" },
                          "scan": "scan.read", "command": "relay.write",
                          "predict": "relay.predict", "reset": "relay.reset" },
               "task": { "priority": 60, "cpus": [0], "offset": "1ms", "deadline": "8ms",
                         "budget": "2ms", "stack": "128KiB", "on_overrun": "stop",
                         "overrun_limit": 3 } },
    "right": { "type": "sample/bare", "core": "sample/repel", "fsm": "sample/periodic",
               "start": false }
  }
})";

/// The architecture with one piece of its text replaced.
inline std::string with(std::string_view what, std::string_view by,
                        std::string_view text = kArchitecture) {
  std::string changed(text);
  const std::size_t found = changed.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return found == std::string::npos ? changed : changed.replace(found, what.size(), by);
}

}  // namespace sample
