// SPDX-License-Identifier: LGPL-3.0-or-later
/// A component that orders a base on a line of the test to drive.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace mauve::test {

inline nlohmann::json guarded_architecture(const std::string& device) {
  const nlohmann::json cruise = {
      {"type", "safety/cruise"},
      {"task", {{"priority", 20}}},
      {"properties", {{"core.velocity", {{"linear", 0.4}, {"angular", 0.0}}}}},
      {"ports", {{"command", "command.write"}}}};
  const nlohmann::json base = {{"type", "drivers/create"},
                               {"task", {{"priority", 30}}},
                               {"properties", {{"core.device", device}, {"core.baud", 0}}},
                               {"ports", {{"command", "command.read"}}}};
  return {{"schema", "mauve/architecture/1"},
          {"name", "guarded"},
          {"plugins", {"types", "drivers", "safety"}},
          {"resources", {{"command", {{"type", "shared_data"}, {"data", "velocity/1"}}}}},
          {"components", {{"cruise", cruise}, {"base", base}}}};
}

}  // namespace mauve::test
