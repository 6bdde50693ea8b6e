// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts of the file that resources and components share: names, types, properties, ports.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arch/parse/spec.h"
#include "arch/text/read.h"

namespace mauve::arch {

/// A text of one of the forms of base/address.h (is_name, is_type_name, is_revised_name).
[[nodiscard]] std::optional<PlacedText> read_name(const Source& source,
                                                  bool (*valid)(std::string_view),
                                                  std::string_view hint);

/// "plugin/name", or a built-in.
[[nodiscard]] std::optional<PlacedText> read_type(const Source& source);

/// Makes a reader that keeps the value that `read` returns, with its place.
template <typename T, typename Read>
auto placed(std::optional<Placed<T>>& into, Read read) {
  return [&into, read](const Source& source) {
    if (auto value = read(source)) into = Placed<T>{static_cast<T>(*value), source.node.where};
  };
}

/// True when the key of a member that names something new is a name; reported otherwise.
[[nodiscard]] bool good_key(const Member& member, const Source& source);

[[nodiscard]] Field type_field(ElementSpec& element);
/// "core" or "fsm": a type name that may be absent.
[[nodiscard]] Field type_name_field(std::string_view key, std::optional<PlacedText>& into);
/// `groups` are the parts that have properties: "core.gain" needs "core".
[[nodiscard]] Field properties_field(ElementSpec& element, std::vector<std::string> groups);
[[nodiscard]] Field ports_field(ElementSpec& element);
/// "fallback_core": a type name, or an object with the properties it is given.
[[nodiscard]] Field fallback_field(std::optional<FallbackSpec>& into);

/// Reports an element without "type".
void require_type(const Source& source, const ElementSpec& element);

}  // namespace mauve::arch
