// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finding things of the running model by their address. [control]
#pragma once

#include <string>
#include <string_view>

#include "arch/parse/target.h"
#include "commands/command.h"

namespace mauve::daemon {

using arch::connection;
using arch::Element;
using arch::split_port;
using arch::Target;

/// "control" -> the element, or unknown_name with the nearest one.
[[nodiscard]] inline Result<Element> find_element(const Running& running, std::string_view name) {
  return arch::find_element(running.architecture, name);
}
[[nodiscard]] inline Result<ComponentBase*> find_component(const Running& running,
                                                           std::string_view name) {
  return arch::find_component(running.architecture, name);
}

/// "control.core.gain", "gnss.core.bad_frames", "control.ports.scan", "scan.read".
[[nodiscard]] inline Result<Target> find_target(const Running& running, std::string_view address) {
  return arch::find_target(running.architecture, address);
}

/// "guidance/gap" -> "guidance"; empty for a type of the program itself.
[[nodiscard]] inline std::string plugin_of(const std::string& type) {
  return type.substr(0, type.find('/') == std::string::npos ? 0 : type.find('/'));
}

/// How a component recovers whose core failed; null: it does not.
[[nodiscard]] inline Json recovery_json(const Recovery& recovery) {
  if (recovery.way == Recovery::Way::none) {
    return nullptr;
  }
  Json json = {{"by", to_string(recovery.way)}};
  if (recovery.way == Recovery::Way::restart) {
    json["in_ns"] = recovery.in.count();
    json["restarts_left"] = recovery.restarts_left;
  }
  return json;
}

/// While this object lives, no element joins or leaves the architecture. A change, or a rollback of
/// the system, adds and removes its elements afterwards. It blocks no thread.
class StandStill {
 public:
  explicit StandStill(const Running& running) : deployer_(running.deployer) {
    deployer_.stand_still(true);
  }
  ~StandStill() { deployer_.stand_still(false); }
  StandStill(const StandStill&) = delete;
  StandStill& operator=(const StandStill&) = delete;

 private:
  Deployer& deployer_;
};

/// From the look of a command to its act. The constructor brings the books up to date with all that
/// the system did by itself. While this object lives, only the command changes the architecture.
/// [control]
class FromLookToAct {
 public:
  explicit FromLookToAct(const Running& running) : still_((running.report_outcomes(), running)) {}

 private:
  StandStill still_;
};

/// The running system in the form of an architecture file. It is of the generation that the
/// deployer reports only while the architecture stands still.
[[nodiscard]] Value described(const Running& running);

}  // namespace mauve::daemon
