// SPDX-License-Identifier: LGPL-3.0-or-later
/// Value: a property or data value on its way between typed C++ and text. Never used on a
/// real-time thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <mauve/host/version.h>

namespace mauve {

/// A tree of null, bool, integer, number, string, array and object (order kept, as written).
class Value {
 public:
  using Array = std::vector<Value>;                           ///< of any values
  using Object = std::vector<std::pair<std::string, Value>>;  ///< members in their order

  Value() = default;                                                ///< null
  Value(bool value) : content_(value) {}                            ///< a boolean
  Value(std::int64_t value) : content_(value) {}                    ///< an integer
  Value(std::uint64_t value);                                       ///< an integer
  Value(int value) : content_(static_cast<std::int64_t>(value)) {}  ///< an integer
  Value(double value) : content_(value) {}                          ///< a number
  Value(std::string value) : content_(std::move(value)) {}          ///< a string
  Value(std::string_view value) : content_(std::string(value)) {}   ///< a string
  Value(const char* value) : content_(std::string(value)) {}        ///< a string
  Value(Array value) : content_(std::move(value)) {}                ///< an array
  Value(Object value) : content_(std::move(value)) {}               ///< an object

  // Not inline: a plugin would have a copy of each wherever it describes a field.
  Value(const Value& other);                 ///< a copy of the tree
  Value(Value&& other) noexcept;             ///< leaves `other` without a defined content
  Value& operator=(const Value& other);      ///< a copy of the tree
  Value& operator=(Value&& other) noexcept;  ///< leaves `other` without a defined content
  ~Value();                                  ///< frees the tree

  [[nodiscard]] bool is_null() const { return content_.index() == 0; }  ///< no value
  /// The content as this alternative, or null when it is another one. An integer is a
  /// std::uint64_t if it is above 2^63 - 1, and a std::int64_t otherwise.
  template <typename T>
  [[nodiscard]] const T* get_if() const {
    return std::get_if<T>(&content_);
  }
  /// An integer or a number as a number; empty for any other content.
  [[nodiscard]] std::optional<double> number() const;
  /// The member of an object with this name, or null.
  [[nodiscard]] const Value* find(std::string_view name) const;

  /// Calls f with the content: std::monostate, bool, std::int64_t, double, std::string, Array,
  /// Object or std::uint64_t.
  template <typename F>
  decltype(auto) visit(F&& f) const {
    return std::visit(std::forward<F>(f), content_);
  }

  friend bool operator==(const Value&, const Value&) = default;  ///< equal kind and content

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object,
               std::uint64_t>
      content_;
};

/// "null", "a boolean", "an integer", "a number", "a string", "an array", "an object".
[[nodiscard]] std::string_view kind_of(const Value& value);

/// Compact text for messages: `0.3`, `nan`, `"10ms"`, `{"x":1,"y":2}`.
[[nodiscard]] std::string to_string(const Value& value);

/// The word for a number that JSON cannot hold, as displays show it and as a string on the wire and
/// in files: "nan", "inf" or "-inf". Empty for a finite number.
[[nodiscard]] std::string_view word_of_number(double number);

}  // namespace mauve
