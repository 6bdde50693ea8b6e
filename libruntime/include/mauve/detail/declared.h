// SPDX-License-Identifier: LGPL-3.0-or-later
/// A wrong declaration of an author is one sentence of the compiler. Each class that is declared as
/// a member has a constructor for all other arguments, which refuses to compile.
#pragma once

#include <cstddef>
#include <type_traits>

namespace mauve::detail {

template <typename... T>
struct Types {};

/// Whether the given arguments are the first of the wanted ones, in their order.
template <typename Wanted, typename Given>
inline constexpr bool kFirstOf = false;
template <typename... Wanted>
inline constexpr bool kFirstOf<Types<Wanted...>, Types<>> = true;
template <typename W, typename... Wanted, typename G, typename... Given>
inline constexpr bool kFirstOf<Types<W, Wanted...>, Types<G, Given...>> =
    std::is_convertible_v<G, W>&& kFirstOf<Types<Wanted...>, Types<Given...>>;

/// Whether arguments are at least so many of the wanted ones; the rest has defaults.
template <std::size_t kLeast, typename Wanted, typename... Given>
inline constexpr bool kDeclares = sizeof...(Given) >= kLeast&& kFirstOf<Wanted, Types<Given...>>;

/// False for all T. It depends on T, so that a static_assert with it fails only where a template is
/// used.
template <typename... T>
inline constexpr bool kNever = false;

/// Stands for an argument of a constructor that refuses to compile.
template <typename T>
T none();

}  // namespace mauve::detail
