// SPDX-License-Identifier: LGPL-3.0-or-later
/// The readers that parse.cpp is made of: one JSON value into one typed value, or a problem.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arch/text/json.h"
#include "arch/text/problem.h"
#include "mauve/time.h"

namespace mauve::arch {

/// A value with its dotted address, and the list to which its problems are reported.
struct Source {
  const Node& node;
  std::string at;
  Problems& problems;

  void refuse(std::string message, std::string hint = {},
              Reason reason = {Errc::invalid_value, "file_value_invalid"}) const;
  /// "expected an integer, got a string".
  void refuse_kind(std::string_view wanted, std::string hint = {}) const;
  /// A value inside this one: its address is `at` and `name` joined by a dot.
  [[nodiscard]] Source inner(const Node& value, std::string_view name) const;
};

/// A key that an object may have, and the reader of its value.
struct Field {
  std::string_view key;
  std::function<void(const Source&)> read;
};

/// Calls the reader of every key. An unknown key is reported with the nearest known one. Returns
/// the members, or null when the value is no object (reported).
const Node::Object* read_object(const Source& source, std::initializer_list<Field> fields);

/// Reports an object without this key; `example` is a text that would do.
void require_key(const Source& source, const Node::Object& members, std::string_view key,
                 std::string_view example);

/// Calls `read` for every member of an object whose keys are free; the key is in the Source's `at`.
void read_members(const Source& source,
                  const std::function<void(const Member&, const Source&)>& read);

/// Calls `read` for every item of an array.
void read_items(const Source& source, const std::function<void(const Source&)>& read);

[[nodiscard]] std::optional<std::string> read_text(const Source& source);
[[nodiscard]] std::optional<bool> read_flag(const Source& source);
[[nodiscard]] std::optional<std::int64_t> read_integer(const Source& source, std::int64_t low,
                                                       std::int64_t high);
[[nodiscard]] std::optional<Duration> read_duration(const Source& source);
/// A duration over 0.
[[nodiscard]] std::optional<Duration> read_positive(const Source& source);
/// "64KiB", "1MiB", "65536B".
[[nodiscard]] std::optional<std::size_t> read_size(const Source& source, std::size_t low,
                                                   std::size_t high);
/// One of the words, as its index.
[[nodiscard]] std::optional<std::size_t> read_word(const Source& source,
                                                   const std::vector<std::string>& words);

/// "did you mean \"priority\"?", or the list when nothing is near.
[[nodiscard]] std::string nearest_hint(std::string_view wanted,
                                       const std::vector<std::string>& known);

}  // namespace mauve::arch
