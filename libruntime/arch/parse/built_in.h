// SPDX-License-Identifier: LGPL-3.0-or-later
/// The resource types that need no plugin.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace mauve {
class ResourceBase;
struct DataType;
}  // namespace mauve

namespace mauve::arch {

inline constexpr std::string_view kSharedData = "shared_data";
inline constexpr std::string_view kRingBuffer = "ring_buffer";

[[nodiscard]] constexpr bool is_built_in(std::string_view type) {
  return type == kSharedData || type == kRingBuffer;
}

/// A resource of a built-in type for `data`, which it keeps (with its library).
[[nodiscard]] std::unique_ptr<ResourceBase> make_built_in(std::string_view type, std::string name,
                                                          std::shared_ptr<const DataType> data);

}  // namespace mauve::arch
