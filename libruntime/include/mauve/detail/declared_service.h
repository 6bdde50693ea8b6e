// SPDX-License-Identifier: LGPL-3.0-or-later
/// A wrong declaration of a service is one sentence of the compiler; see declared.h.
#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>

#include <mauve/detail/declared.h>

namespace mauve {

class InterfaceBase;
enum class Writers : std::uint8_t;
template <typename CoreT>
class Interface;

namespace detail {

/// Whether a service is declared with its interface, its name, and a method of the core of one of
/// these types.
template <typename Owner, typename Method>
struct OfCore;
template <typename C, typename R, typename... P>
struct OfCore<C, R(P...)> {
  using type = R (C::*)(P...);
};
template <typename C>
C* core_of(const Interface<C>& owner);

template <typename Methods, typename... Given>
inline constexpr bool kServes = false;
template <typename... Method, typename Owner, typename Name, typename Given, typename... Rest>
requires requires(Owner owner) { core_of(owner); }
inline constexpr bool kServes<void(Method...), Owner, Name, Given, Rest...> =
    std::is_convertible_v<Name, std::string_view> && kFirstOf<Types<Writers>, Types<Rest...>> &&
    (std::is_convertible_v<
         Given, typename OfCore<std::remove_pointer_t<decltype(core_of(std::declval<Owner>()))>,
                                std::remove_pointer_t<Method>>::type> ||
     ...);

template <typename... Wrong>
InterfaceBase& wrong_service() {
  static_assert(kNever<Wrong...>,
                "mauve: a service is a member of an interface, declared as `NAME{*this, \"NAME\", "
                "&YourCore::method};`: a ReadService<T> with a method `T method()` of its core, a "
                "WriteService<T> with `void method(const T&)`, a CallService<R(P...)> with "
                "`R method(P...)`, an EventService<P...> with `void method(P...)`");
  return none<InterfaceBase&>();
}

}  // namespace detail
}  // namespace mauve
