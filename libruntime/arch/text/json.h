// SPDX-License-Identifier: LGPL-3.0-or-later
/// JSON text as a tree in which every value and every key knows its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "arch/text/problem.h"
#include "mauve/host/value.h"

namespace mauve::arch {

struct Member;

/// One JSON value. Members of an object keep their order.
struct Node {
  using Array = std::vector<Node>;
  using Object = std::vector<Member>;

  Position where;
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object,
               std::uint64_t>
      content;  ///< a std::uint64_t is above 2^63 - 1

  /// The content as this alternative, or null when it is another one.
  template <typename T>
  [[nodiscard]] const T* get_if() const {
    return std::get_if<T>(&content);
  }
};

/// One `"key": value` of an object; `where` is the place of the key.
struct Member {
  std::string key;
  Position where;
  Node value;
};

struct JsonLimits {
  std::size_t bytes = 1 << 20;  ///< longest text
  std::size_t depth = 32;       ///< containers within containers; the root is the first
};

/// Reads one JSON value that fills `text`. Comments are accepted. Refused, each with its place:
/// syntax errors, invalid UTF-8, NaN and infinite numbers, integers beyond 64 bits signed, too much
/// depth, too long a text; nothing is returned then. A key twice in one object is a problem too,
/// but the tree is returned, with both members, so that other problems are found too. Never throws.
/// [any]
[[nodiscard]] std::optional<Node> parse_json(std::string_view text, Problems& problems,
                                             const JsonLimits& limits = {});

/// The same tree without places.
[[nodiscard]] Value to_value(const Node& node);

/// "null", "a boolean", "an integer", "a number", "a string", "an array", "an object".
[[nodiscard]] std::string_view kind_of(const Node& node);

}  // namespace mauve::arch
