// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which numbers a value holds, and which values a write port lets out. Included by port.h.
#pragma once

#include <concepts>
#include <functional>
#include <tuple>
#include <type_traits>

#include <mauve/detail/codec.h>

namespace mauve {
namespace detail {

/// True when `holds(number)` for every floating-point number in the value: for a number itself, for
/// the fields of a described type, and for the items of arrays. Other content is not looked at.
/// [rt], as long as the value is large.
template <typename T, typename Holds>
[[nodiscard]] bool all_numbers(const T& value, Holds holds) {
  if constexpr (std::floating_point<T>) {
    return holds(value);
  } else if constexpr (HasFields<T>) {
    const auto in_each = [&](const auto&... f) {
      return (all_numbers(value.*(f.member), holds) && ...);
    };
    return std::apply(in_each, Described<T>::fields());
  } else if constexpr (requires { value.begin() != value.end(); }) {
    using Item = std::remove_cvref_t<decltype(*value.begin())>;
    if constexpr (std::floating_point<Item> || std::is_class_v<Item>) {
      for (const Item& item : value) {
        if (!all_numbers(item, holds)) return false;
      }
    }
    return true;
  } else {
    return true;
  }
}

/// True when no number in the value is a NaN or an infinity. [rt]
template <typename T>
[[nodiscard]] bool all_finite(const T& value) {
  return all_numbers(value, [](auto number) { return __builtin_isfinite(number); });
}

}  // namespace detail

/// The values that a port lets out. The port asks on the real-time thread before each write; `last`
/// is the value before, or `value` itself at first: `[](double v, double last) { return
/// std::abs(v - last) < 0.1; }`. A NaN or an infinity in a described field is not plausible either,
/// unless `finite` is false; `accepts` is asked only afterwards. `Plausible<T>{}` asks for finite
/// numbers alone. A port without Plausible checks nothing, and pays nothing. A value that is not
/// let out is counted, and readers keep the value before: see PortBase::implausible().
/// @snippet api_examples.cpp Plausible
template <typename T>
struct Plausible {
  /// asked last; empty: accepts all
  std::function<bool(const T& value, const T& last)> accepts = {};
  bool finite = true;  ///< refuses NaN and infinity

  /// Whether the port lets the value out. [rt]
  [[nodiscard]] bool operator()(const T& value, const T& last) const {
    return (!finite || detail::all_finite(value)) && (!accepts || accepts(value, last));
  }
};

}  // namespace mauve
