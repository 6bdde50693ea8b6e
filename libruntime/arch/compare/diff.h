// SPDX-License-Identifier: LGPL-3.0-or-later
/// The change that turns a running architecture into the one of another file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arch/compare/describe.h"
#include "mauve/host/change.h"
#include "mauve/host/value.h"

namespace mauve {
class Architecture;
class ComponentBase;
class ResourceBase;
}  // namespace mauve

namespace mauve::arch {

/// One difference, for people and scripts.
struct Line {
  enum class Op : std::uint8_t { add, remove, change };
  Op op = Op::change;
  /// "architecture", "plugin", "resource", "component", "core", "fsm", "fallback_core",
  /// "property", "port", "lock_budget", "task" or "start".
  std::string kind;
  std::string address;  ///< "control.core.gain", "control.ports.scan", "control.task.priority"
  Value before;         ///< as in the file; of a component or resource its type; null: nothing
  Value after;

  friend bool operator==(const Line&, const Line&) = default;
};
[[nodiscard]] std::string_view to_string(Line::Op op);

/// A line: `before` is null in an addition, `after` in a removal.
[[nodiscard]] Line make_line(std::string kind, std::string address, Value before, Value after);

/// A change, and its description as lines. When nothing differs, there are no lines and the change
/// is empty.
struct Difference {
  Change change;
  std::vector<Line> lines;
  /// Resources that get another contract under their name, while others use them, or with a state
  /// or values that go on. Such a change needs Sync::barrier; compare() leaves it a cut.
  std::vector<std::string> exchanged;
};

/// Compares by name. `wanted` was made from a file (load(), build()): nothing in it is configured,
/// and it owns its elements. Those that join are moved out of it; it is left without connections,
/// and can be freed by any thread.
///
/// A component of another type leaves and joins again under its name. A resource leaves and joins
/// again when its type, its data, or the properties of its shell or interface differ: these
/// properties cannot change while it runs. Every port at such a resource is connected anew. A core
/// of another type begins with its defaults, so all its other properties are in the change. A state
/// machine takes over the values of the old one by the same name. Lines come in the order of
/// `wanted`, resources first, each followed by the elements that leave. A new name of the
/// architecture is a line, and no change. Without `parked`, the attribute `start` decides which
/// components run. [control]
[[nodiscard]] Difference compare(const Architecture& running, Architecture& wanted,
                                 const Parked& parked = {});

/// "guidance/control", "shared_data velocity/1": the type of an element as lines give it.
[[nodiscard]] std::string title_of(const ComponentBase& component);
[[nodiscard]] std::string title_of(const ResourceBase& resource);

/// Equal content: numbers by value (1 is 1.0), not a number is itself.
[[nodiscard]] bool same_value(const Value& a, const Value& b);

}  // namespace mauve::arch
