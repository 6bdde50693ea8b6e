// SPDX-License-Identifier: LGPL-3.0-or-later
/// How numbers, texts and durations become Value and back; codec.h builds arrays and structs of
/// them. Included by codec.h.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <mauve/bounded.h>
#include <mauve/detail/field.h>
#include <mauve/host/value.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

/// The description of T: `name`, and what else type.h says. A struct of your own has it inside;
/// specialise this for a struct that you cannot change.
template <typename T>
struct Described {};

namespace detail {

template <typename T>
concept DescribesItself = requires {
  { T::type_name } -> std::convertible_to<std::string_view>;
};

template <typename T>
struct OwnBefore {};
template <typename T>
requires requires { typename T::Before; }
struct OwnBefore<T> {
  using Before = typename T::Before;
};

}  // namespace detail

template <detail::DescribesItself T>
struct Described<T> : detail::OwnBefore<T> {
  static constexpr std::string_view name = T::type_name;
  static constexpr auto fields() requires requires { T::fields(); }
  { return T::fields(); }
  template <typename Old>
  static void convert(const Old& old,
                      T& now) noexcept(noexcept(T::convert(old, now))) requires requires {
    T::convert(old, now);
  }
  { T::convert(old, now); }
};

/// Parses "10ms", formats it back. Defined by the base layer.
[[nodiscard]] Result<Duration> parse_duration(std::string_view text);
[[nodiscard]] std::string format_duration(Duration duration);

namespace detail {

template <typename T>
concept HasName = requires {
  { Described<T>::name } -> std::convertible_to<std::string_view>;
};
template <typename T>
concept HasFields = HasName<T> && requires {
  Described<T>::fields();
};

// These are in libmauve, which keeps the code that each type adds to a plugin small.

[[nodiscard]] Error wrong_kind(std::string_view wanted, const Value& value);

/// The place of an error in a composed value, seen from outside: "y" in `goal` is "goal.y".
[[nodiscard]] Status inside(Status done, const std::string& part);

void add_member(Value::Object& object, std::string_view name, Value value);

/// Adds the description of a field to those of its struct.
void add_field(Value::Array& fields, std::string_view name, Value kind, std::string_view unit,
               std::string_view text);

/// "point2d/1 has the fields x, y"
[[nodiscard]] std::string fields_in_words(std::string_view type,
                                          std::span<const std::string_view> fields);

/// The struct `type` has no field of this name.
[[nodiscard]] Error no_field(const std::string& name, std::string_view type,
                             std::span<const std::string_view> fields);

/// The number that "nan", "inf" or "-inf" stands for; empty for any other value.
[[nodiscard]] std::optional<double> number_of_word(const Value& value);

/// "not an integer from 0 to 255: 300"
[[nodiscard]] Error out_of_range(std::int64_t low, std::uint64_t high, const Value& value);

/// "is a text of 900000 bytes, and at most 4096 are taken"
[[nodiscard]] Error text_too_long(std::size_t most, std::size_t size);

/// Of a property that is a std::string, in bytes: it is copied, saved and shown whole.
inline constexpr std::size_t kLongestString = 4096;

}  // namespace detail

/// Conversion of one type; empty for types without description.
template <typename T>
struct Codec {};

template <>
struct Codec<bool> {
  static Value encode(bool data) { return data; }
  static Status decode(const Value& value, bool& data) {
    const bool* b = value.get_if<bool>();
    if (b == nullptr) return detail::wrong_kind("true or false", value);
    data = *b;
    return ok();
  }
  static Value describe() { return "bool"; }
};

template <std::integral T>
requires(!detail::kCharacter<T>) struct Codec<T> {
  using Widest = std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>;

  static Value encode(T data) { return static_cast<Widest>(data); }
  static Status decode(const Value& value, T& data) {
    const auto take = [&](auto integer) -> Status {
      if (!std::in_range<T>(integer)) return detail::out_of_range(kLow, kHigh, value);
      data = static_cast<T>(integer);
      return ok();
    };
    if (const auto* i = value.get_if<std::int64_t>()) return take(*i);
    if (const auto* i = value.get_if<std::uint64_t>()) return take(*i);
    return detail::wrong_kind("an integer", value);
  }
  static Value describe() {
    return std::string(std::is_signed_v<T> ? "int" : "uint") + std::to_string(8 * sizeof(T));
  }

 private:
  static constexpr std::int64_t kLow =
      std::is_signed_v<T> ? static_cast<std::int64_t>(std::numeric_limits<T>::min()) : 0;
  static constexpr std::uint64_t kHigh = static_cast<std::uint64_t>(std::numeric_limits<T>::max());
};

template <std::floating_point T>
requires(!detail::kLongDouble<T>) struct Codec<T> {
  static Value encode(T data) { return static_cast<double>(data); }
  static Status decode(const Value& value, T& data) {
    if (const auto number = value.number()) {
      data = static_cast<T>(*number);
    } else if (const auto word = detail::number_of_word(value)) {
      data = static_cast<T>(*word);
    } else {
      return detail::wrong_kind("a number", value);
    }
    return ok();
  }
  static Value describe() { return sizeof(T) == 4 ? "float" : "double"; }
};

template <>
struct Codec<std::string> {
  static Value encode(const std::string& data) { return data; }
  static Status decode(const Value& value, std::string& data) {
    const auto* s = value.get_if<std::string>();
    if (s == nullptr) return detail::wrong_kind("a string", value);
    if (s->size() > detail::kLongestString) {
      return detail::text_too_long(detail::kLongestString, s->size());
    }
    data = *s;
    return ok();
  }
  static Value describe() { return "string"; }
};

template <>
struct Codec<Duration> {
  static Value encode(Duration data) { return format_duration(data); }
  static Status decode(const Value& value, Duration& data) {
    const auto* s = value.get_if<std::string>();
    if (s == nullptr) return detail::wrong_kind("a duration with a unit such as \"10ms\"", value);
    const Result<Duration> parsed = parse_duration(*s);
    if (!parsed) return parsed.error();
    data = *parsed;
    return ok();
  }
  static Value describe() { return "duration"; }
};

template <std::size_t N>
struct Codec<Text<N>> {
  static Value encode(const Text<N>& data) { return std::string(data.view()); }
  static Status decode(const Value& value, Text<N>& data) {
    const auto* s = value.get_if<std::string>();
    if (s == nullptr) return detail::wrong_kind("a string", value);
    if (s->size() > N) return detail::text_too_long(N, s->size());
    data = std::string_view(*s);
    return ok();
  }
  static Value describe() { return "text[" + std::to_string(N) + "]"; }
};

}  // namespace mauve
