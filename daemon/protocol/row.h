// SPDX-License-Identifier: LGPL-3.0-or-later
/// The words in which the rows of methods.def are written: types and fields.
#pragma once

#include "protocol/field.h"

namespace mauve::protocol::row {

inline constexpr Type text{Type::Kind::text};
inline constexpr Type boolean{Type::Kind::boolean};
inline constexpr Type count{Type::Kind::count};
inline constexpr Type integer{Type::Kind::integer};
inline constexpr Type number{Type::Kind::number};
inline constexpr Type duration{Type::Kind::duration};
inline constexpr Type time{Type::Kind::time};
inline constexpr Type value{Type::Kind::value};
inline constexpr Type object{Type::Kind::object};
inline constexpr Type ns{Type::Kind::integer, "ns"};
inline constexpr Type seconds{Type::Kind::number, "s"};
inline constexpr Type bytes{Type::Kind::count, "bytes"};

constexpr Type in(Type type, std::string_view unit) {
  type.unit = unit;
  return type;
}
constexpr Type one_of(std::string_view choices) { return {Type::Kind::text, {}, choices}; }
constexpr Type of(const Record& record) { return {Type::Kind::record, {}, {}, &record}; }
constexpr Type list(Type type) {
  type.shape = Type::Shape::list;
  return type;
}
constexpr Type list(const Record& record) { return list(of(record)); }
constexpr Type map(Type type) {
  type.shape = Type::Shape::map;
  return type;
}
constexpr Type or_null(Type type) {
  type.nullable = true;
  return type;
}

/// A field that is always there, and a parameter that must be given.
constexpr Field has(std::string_view name, Type type, std::string_view text_of_field) {
  return {name, type, text_of_field};
}
constexpr Field needs(std::string_view name, Type type, std::string_view text_of_field) {
  return {name, type, text_of_field};
}
/// A field or a parameter that may be absent.
constexpr Field may(std::string_view name, Type type, std::string_view text_of_field) {
  return {name, type, text_of_field, true};
}

}  // namespace mauve::protocol::row
