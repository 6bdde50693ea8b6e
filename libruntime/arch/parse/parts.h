// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts of a component or resource by the names they have in addresses.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mauve {
class ComponentBase;
class Configurable;
class ObservableBase;
class PropertyBase;
class ResourceBase;
}  // namespace mauve

namespace mauve::arch {

/// "shell", "core", and "fsm" or "interface". Null: it could not be made.
using Parts = std::array<std::pair<std::string_view, Configurable*>, 3>;

[[nodiscard]] Parts parts_of(const ComponentBase& component);
[[nodiscard]] Parts parts_of(const ResourceBase& resource);

/// Does "core.gain" belong to a part that could not be made?
[[nodiscard]] bool is_of_missing_part(const Parts& parts, std::string_view name);
/// "core.gain" -> the property, or null.
[[nodiscard]] PropertyBase* find_property(const Parts& parts, std::string_view name);
/// "core.bad_frames" -> the observable, or null.
[[nodiscard]] ObservableBase* find_observable(const Parts& parts, std::string_view name);

/// "core.gain" and so on, in the order of declaration.
[[nodiscard]] std::vector<std::string> property_names(const Parts& parts);

}  // namespace mauve::arch
