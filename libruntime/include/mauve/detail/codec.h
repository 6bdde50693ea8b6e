// SPDX-License-Identifier: LGPL-3.0-or-later
/// How typed values become Value and back, and the fixed-capacity building blocks of data types.
/// Included by type.h; authors describe their types as type.h shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <typeinfo>
#include <utility>

#include <mauve/bounded.h>
#include <mauve/detail/class_name.h>
#include <mauve/detail/codec_scalar.h>
#include <mauve/detail/declared.h>
#include <mauve/host/value.h>
#include <mauve/result.h>

namespace mauve {

namespace detail {

template <typename T>
concept HasCodec = requires(const T& data, T& into, const Value& value) {
  Codec<T>::encode(data);
  Codec<T>::decode(value, into);
};

/// The name that identifies T across plugins.
template <typename T>
std::string type_name() {
  if constexpr (HasName<T>) {
    return std::string(Described<T>::name);
  } else if constexpr (std::is_void_v<T>) {
    return "void";
  } else if constexpr (HasCodec<T>) {
    const Value described = Codec<T>::describe();
    if (const auto* text = described.get_if<std::string>()) return *text;
    return class_name(typeid(T));
  } else {
    return class_name(typeid(T));
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
      Status done = Codec<T>::decode((*array)[i], data[i]);
      if (!done) return detail::inside(std::move(done), "[" + std::to_string(i) + "]");
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
      Status done = Codec<T>::decode(item, decoded);
      if (!done) return detail::inside(std::move(done), "[" + std::to_string(data.size()) + "]");
      data.push_back(decoded);
    }
    return ok();
  }
  static Value describe() {
    return Value::Object{{"array", Codec<T>::describe()},
                         {"capacity", static_cast<std::int64_t>(N)}};
  }
};

namespace detail {

/// fields() is a tuple of members of T, whose types have a conversion too.
template <typename T, typename F>
inline constexpr bool kFieldOf = false;
template <typename T, typename Owner, typename M>
inline constexpr bool kFieldOf<T, Field<Owner, M>> = std::is_base_of_v<Owner, T>&& HasCodec<M>;
template <typename T, typename Fields>
inline constexpr bool kFieldsOf = false;
template <typename T, typename... F>
inline constexpr bool kFieldsOf<T, std::tuple<F...>> = (kFieldOf<T, F> && ...);

/// A field that field() has refused by its own sentence.
template <typename Fields>
inline constexpr bool kHasNoField = false;
template <typename Owner, typename... M>
inline constexpr bool kHasNoField<std::tuple<Field<Owner, M>...>> = (kNoField<M> || ...);

/// Stands for a value of any member of the aggregate T, but for none of a base class.
template <typename T>
struct AnyMember {
  template <typename M>
  requires(!std::is_base_of_v<M, T>) operator M() const noexcept;
};

/// Has the aggregate T at least `I...` + 1 members? Members of a base class do not count.
template <typename T, std::size_t... I>
constexpr bool has_more_members(std::index_sequence<I...>) {
  return requires { T{AnyMember<T>{}, (static_cast<void>(I), AnyMember<T>{})...}; };
}

template <typename T>
inline constexpr std::size_t kFields = std::tuple_size_v<decltype(Described<T>::fields())>;

/// fields() describes each member of T, or none: then T is opaque. Members are counted in an
/// aggregate only.
template <typename T>
inline constexpr bool kDescribesAll = kFields<T> == 0 || !std::is_aggregate_v<T> ||
                                      !has_more_members<T>(std::make_index_sequence<kFields<T>>());

/// A description that is right.
template <typename T>
concept HasGoodFields = HasFields<T> && kFieldsOf<T, decltype(Described<T>::fields())>;

}  // namespace detail

template <detail::HasFields T>
struct Codec<T> {
  static_assert(detail::kHasNoField<decltype(Described<T>::fields())>,
                "mauve: fields() of a described type T returns `std::tuple{mauve::field(\"NAME\", "
                "&T::NAME), ...}` of members of T; the type of each is described too");
  static Value encode(const T& data);
  static Status decode(const Value& value, T& data);
  static Value describe();
};

template <detail::HasGoodFields T>
struct Codec<T> {
  static Value encode(const T& data) {
    Value::Object object;
    std::apply(
        [&](const auto&... f) {
          (detail::add_member(
               object, f.name,
               Codec<std::remove_cvref_t<decltype(data.*(f.member))>>::encode(data.*(f.member))),
           ...);
        },
        Described<T>::fields());
    return object;
  }
  /// Members that the object does not name keep their value; a name that is no field is refused.
  static Status decode(const Value& value, T& data) {
    const auto* object = value.get_if<Value::Object>();
    if (object == nullptr) {
      Error error = detail::wrong_kind("an object", value);
      error.hint = detail::fields_in_words(Described<T>::name, names());
      return error;
    }
    for (const auto& member : *object) {
      Status done = detail::no_field(member.first, Described<T>::name, names());
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
          (detail::add_field(
               fields, f.name,
               Codec<std::remove_cvref_t<decltype(std::declval<T>().*(f.member))>>::describe(),
               f.unit, f.text),
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
    done = detail::inside(Codec<std::remove_cvref_t<decltype(field)>>::decode(member.second, field),
                          member.first);
    return true;
  }
  static std::span<const std::string_view> names() {
    static const auto kNames = std::apply(
        [](const auto&... f) { return std::array<std::string_view, sizeof...(f)>{f.name...}; },
        Described<T>::fields());
    return kNames;
  }
};

}  // namespace mauve
