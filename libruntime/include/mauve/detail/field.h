// SPDX-License-Identifier: LGPL-3.0-or-later
/// The fields of a described struct, and the types that no field has. Included by codec_scalar.h.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <type_traits>

namespace mauve {

template <typename T, std::size_t N>
class Bounded;

/// One field of a described struct: name, member, unit and text for people.
template <typename Owner, typename T>
struct Field {
  std::string_view name;
  T Owner::*member;
  std::string_view unit;
  std::string_view text;
};

namespace detail {

/// The type of the items of an array, however deep; another type is its own.
template <typename T>
struct Innermost {
  using Type = T;
};
template <typename T, std::size_t N>
struct Innermost<std::array<T, N>> : Innermost<T> {};
template <typename T, std::size_t N>
struct Innermost<Bounded<T, N>> : Innermost<T> {};

template <typename T, typename... Of>
inline constexpr bool kOneOf = (std::is_same_v<T, Of> || ...);
template <typename T>
inline constexpr bool kCharacter = kOneOf<T, char, wchar_t, char8_t, char16_t, char32_t>;
template <typename T>
inline constexpr bool kLongDouble = std::is_same_v<T, long double>;

/// A type that field() refuses by a sentence of its own.
template <typename T, typename Item = typename Innermost<T>::Type>
inline constexpr bool kNoField = std::is_enum_v<Item> || kCharacter<Item> || kLongDouble<Item>;

}  // namespace detail

template <typename Owner, typename T>
constexpr Field<Owner, T> field(std::string_view name, T Owner::*member, std::string_view unit = {},
                                std::string_view text = {}) {
  using Item = typename detail::Innermost<T>::Type;
  static_assert(
      !std::is_enum_v<Item>,
      "mauve: an enumeration is no field: declare the member as std::int32_t, and convert "
      "it where the core uses it");
  static_assert(!detail::kCharacter<Item>,
                "mauve: a character is no field: declare a text as mauve::Text<N>, and a byte as "
                "std::uint8_t");
  static_assert(!detail::kLongDouble<Item>,
                "mauve: a long double is no field: declare the member as double");
  return {name, member, unit, text};
}

}  // namespace mauve
