// SPDX-License-Identifier: LGPL-3.0-or-later
/// How typed values become Value and back, and the fixed-capacity building blocks of data types.
/// Included by type.h; authors specialise `mauve::Described<T>` only.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <typeinfo>

#include <mauve/bounded.h>
#include <mauve/result.h>
#include <mauve/time.h>
#include <mauve/value.h>

namespace mauve {

/// Specialise for a struct of your own; see type.h.
template <typename T>
struct Described {};

/// One field of a described struct: name, member, unit and text for people.
template <typename Owner, typename T>
struct Field {
  std::string_view name;
  T Owner::*member;
  std::string_view unit;
  std::string_view text;
};

template <typename Owner, typename T>
constexpr Field<Owner, T> field(std::string_view name, T Owner::*member, std::string_view unit = {},
                                std::string_view text = {}) {
  return {name, member, unit, text};
}

/// Parses "10ms", formats it back. Defined by the base layer.
[[nodiscard]] Result<Duration> parse_duration(std::string_view text);
[[nodiscard]] std::string format_duration(Duration duration);

namespace detail {

template <typename T>
concept HasFields = requires {
  { Described<T>::name } -> std::convertible_to<std::string_view>;
  Described<T>::fields();
};

[[nodiscard]] inline Error wrong_kind(std::string_view wanted, const Value& value) {
  return refuse(Errc::invalid_value, {},
                "expected " + std::string(wanted) + ", got " + to_string(value));
}

/// "not an integer from 0 to 255: 300"
[[nodiscard]] Error out_of_range(std::int64_t low, std::int64_t high, const Value& value);

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
struct Codec<T> {
  static Value encode(T data) { return static_cast<std::int64_t>(data); }
  static Status decode(const Value& value, T& data) {
    const auto* i = value.get_if<std::int64_t>();
    if (i == nullptr) return detail::wrong_kind("an integer", value);
    if (!std::in_range<T>(*i)) return detail::out_of_range(kLow, kHigh, value);
    data = static_cast<T>(*i);
    return ok();
  }
  static Value describe() {
    return std::string(std::is_signed_v<T> ? "int" : "uint") + std::to_string(8 * sizeof(T));
  }

 private:
  static constexpr std::int64_t kLow =
      std::is_signed_v<T> ? static_cast<std::int64_t>(std::numeric_limits<T>::min()) : 0;
  static constexpr std::int64_t kHigh =
      std::in_range<std::int64_t>(std::numeric_limits<T>::max())
          ? static_cast<std::int64_t>(std::numeric_limits<T>::max())
          : std::numeric_limits<std::int64_t>::max();
};

template <std::floating_point T>
struct Codec<T> {
  static Value encode(T data) { return static_cast<double>(data); }
  static Status decode(const Value& value, T& data) {
    if (const auto* d = value.get_if<double>()) {
      data = static_cast<T>(*d);
    } else if (const auto* i = value.get_if<std::int64_t>()) {
      data = static_cast<T>(*i);
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
    if (s->size() > N) return detail::out_of_range(0, N, static_cast<std::int64_t>(s->size()));
    data = std::string_view(*s);
    return ok();
  }
  static Value describe() { return "text[" + std::to_string(N) + "]"; }
};

namespace detail {

template <typename T>
concept HasCodec = requires(const T& data, T& into, const Value& value) {
  Codec<T>::encode(data);
  Codec<T>::decode(value, into);
};

/// The name that identifies T across plugins.
template <typename T>
std::string type_name() {
  if constexpr (HasFields<T>) {
    return std::string(Described<T>::name);
  } else if constexpr (std::is_void_v<T>) {
    return "void";
  } else if constexpr (HasCodec<T>) {
    const Value described = Codec<T>::describe();
    if (const auto* text = described.get_if<std::string>()) return *text;
    return typeid(T).name();
  } else {
    return typeid(T).name();
  }
}

template <typename Sequence>
Value encode_sequence(const Sequence& data) {
  Value::Array array;
  array.reserve(data.size());
  for (const auto& item : data) {
    array.push_back(Codec<std::remove_cvref_t<decltype(item)>>::encode(item));
  }
  return array;
}

}  // namespace detail

template <detail::HasCodec T, std::size_t N>
struct Codec<std::array<T, N>> {
  static Value encode(const std::array<T, N>& data) { return detail::encode_sequence(data); }
  static Status decode(const Value& value, std::array<T, N>& data) {
    const auto* array = value.get_if<Value::Array>();
    if (array == nullptr || array->size() != N) {
      return detail::wrong_kind("an array of " + std::to_string(N) + " items", value);
    }
    for (std::size_t i = 0; i < N; ++i) {
      if (Status done = Codec<T>::decode((*array)[i], data[i]); !done) return done;
    }
    return ok();
  }
  static Value describe() {
    return Value::Object{{"array", Codec<T>::describe()}, {"size", static_cast<std::int64_t>(N)}};
  }
};

template <detail::HasCodec T, std::size_t N>
struct Codec<Bounded<T, N>> {
  static Value encode(const Bounded<T, N>& data) { return detail::encode_sequence(data); }
  static Status decode(const Value& value, Bounded<T, N>& data) {
    const auto* array = value.get_if<Value::Array>();
    if (array == nullptr || array->size() > N) {
      return detail::wrong_kind("an array of at most " + std::to_string(N) + " items", value);
    }
    data.clear();
    for (const Value& item : *array) {
      T decoded{};
      if (Status done = Codec<T>::decode(item, decoded); !done) return done;
      data.push_back(decoded);
    }
    return ok();
  }
  static Value describe() {
    return Value::Object{{"array", Codec<T>::describe()},
                         {"capacity", static_cast<std::int64_t>(N)}};
  }
};

template <detail::HasFields T>
struct Codec<T> {
  static Value encode(const T& data) {
    Value::Object object;
    std::apply(
        [&](const auto&... f) {
          (object.emplace_back(
               std::string(f.name),
               Codec<std::remove_cvref_t<decltype(data.*(f.member))>>::encode(data.*(f.member))),
           ...);
        },
        Described<T>::fields());
    return object;
  }
  /// Members that the object does not name keep their value; a name that is no field is refused.
  static Status decode(const Value& value, T& data) {
    const auto* object = value.get_if<Value::Object>();
    if (object == nullptr) return detail::wrong_kind("an object", value);
    for (const auto& member : *object) {
      Status done = refuse(Errc::unknown_name, member.first,
                           "no field of " + std::string(Described<T>::name));
      const auto try_fields = [&](const auto&... f) {
        static_cast<void>((decode_field(f, member, data, done) || ...));
      };
      std::apply(try_fields, Described<T>::fields());
      if (!done) return done;
    }
    return ok();
  }
  static Value describe() {
    Value::Array fields;
    std::apply(
        [&](const auto&... f) {
          (fields.push_back(Value::Object{
               {"name", std::string(f.name)},
               {"kind",
                Codec<std::remove_cvref_t<decltype(std::declval<T>().*(f.member))>>::describe()},
               {"unit", std::string(f.unit)},
               {"text", std::string(f.text)}}),
           ...);
        },
        Described<T>::fields());
    return fields;
  }

 private:
  template <typename F>
  static bool decode_field(const F& f, const std::pair<std::string, Value>& member, T& data,
                           Status& done) {
    if (member.first != f.name) return false;
    auto& field = data.*(f.member);
    done = Codec<std::remove_cvref_t<decltype(field)>>::decode(member.second, field);
    if (!done && done.error().at.empty()) done.error().at = member.first;
    return true;
  }
};

}  // namespace mauve
