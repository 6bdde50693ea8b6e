// SPDX-License-Identifier: LGPL-3.0-or-later
/// The types of the table of methods: the values that a parameter, or a field of an answer, may
/// hold.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/framing.h"

namespace mauve::protocol {

struct Record;

/// The type of a value on the wire. Constant data, which any thread may read.
struct Type {
  enum class Kind : std::uint8_t {
    text,
    boolean,
    count,     ///< an integer of 0 or more
    integer,   ///< an integer that may be negative
    number,    ///< a floating-point number; "nan", "inf", "-inf" stand for those JSON cannot hold
    duration,  ///< a text, a number and a unit such as "50ms"
    time,      ///< a text, an instant in UTC such as "2026-01-31T12:00:00Z"
    value,     ///< any JSON value
    object,    ///< an object whose members the table does not name
    record,    ///< an object whose members are the fields of `record`
  };
  enum class Shape : std::uint8_t {
    one,
    list,  ///< an array of such values
    map,   ///< an object whose members all are such values
  };

  Kind kind = Kind::text;
  std::string_view unit = {};      ///< "ns", "s", "bytes"; empty: the value has no unit
  std::string_view choices = {};   ///< of a text: the only words allowed, a blank between them
  const Record* record = nullptr;  ///< of Kind::record, never null there
  Shape shape = Shape::one;
  bool nullable = false;  ///< null is allowed in place of the whole value
};

/// A parameter of a method, or a field of an answer or of a record.
struct Field {
  std::string_view name;
  Type type;
  std::string_view text;  ///< one sentence without its full stop
  bool optional = false;  ///< the field may be absent
};

/// A kind of object that answers hold in one or several places.
struct Record {
  std::string_view name;  ///< "ReceiptMember", unique
  std::string_view text;  ///< one sentence without its full stop
  std::span<const Field> fields;
};

/// The words of `choices`.
[[nodiscard]] std::vector<std::string> choices_of(const Type& type);

/// "text", "list of integer in ns", "Line or null": the type in words, for manuals and messages.
[[nodiscard]] std::string in_words(const Type& type);

/// The text of the field as a sentence, and its choices.
[[nodiscard]] std::string sentence_of(const Field& field);

/// Whether a value has the JSON type that `type` asks for. Choices count; the form of a duration or
/// of a time does not, and neither do the members of a record.
[[nodiscard]] bool fits(const Json& value, const Type& type);

/// "a string", "an array of strings", "one of cut, barrier": for the message about a wrong
/// argument.
[[nodiscard]] std::string expected_words(const Type& type);

}  // namespace mauve::protocol
