// SPDX-License-Identifier: LGPL-3.0-or-later
/// From a running architecture back to the form of the file.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mauve/host/component.h"
#include "mauve/host/value.h"
#include "rules/supervision.h"

namespace mauve {
class Architecture;
class Binding;
class ResourceBase;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// Is this component parked now? It is then exported with "start": false.
using Parked = std::function<bool(const ComponentBase&)>;

/// The task attributes except `start` as in the file: all of them, always in the same order, null
/// for an attribute that the file leaves out. [any]
[[nodiscard]] std::vector<std::pair<std::string_view, Value>> describe_task(
    const TaskAttributes& attributes);
/// A fault policy, a lock budget, a connection and a fallback core as in the file; null: there is
/// none. [control]
[[nodiscard]] Value describe_fault_policy(const FaultPolicy& policy);
[[nodiscard]] Value describe_lock_budget(const ResourceBase& resource);
[[nodiscard]] Value describe_connection(const Binding* binding);
[[nodiscard]] Value describe_fallback(const std::optional<ComponentBase::Fallback>& fallback);

/// The architecture as its file would be written: a key with its default value is left out. Reading
/// the result (parse, build) gives the same system: elements, cores, state machines, property
/// values, connections, task attributes and supervision. Without `parked`, the task attribute
/// `start` decides. `lost`: see lost_of(). [control]
[[nodiscard]] Value describe(const Architecture& architecture, const plugin::Catalog& catalog,
                             const Parked& parked = {}, const rules::Supervision& supervision = {},
                             const std::vector<std::string>& lost = {});

}  // namespace mauve::arch
