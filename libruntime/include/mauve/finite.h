// SPDX-License-Identifier: LGPL-3.0-or-later
/// Whether a value has a NaN or an infinity in it. Included by port.h.
#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>

#include <mauve/codec.h>

namespace mauve::detail {

/// True when every floating-point number in the value is finite: in a number itself, in the fields
/// of a described type, and in the items of arrays. Other content is not looked at. [rt], as long
/// as the value is large.
template <typename T>
[[nodiscard]] bool all_finite(const T& value) {
  if constexpr (std::floating_point<T>) {
    return __builtin_isfinite(value);
  } else if constexpr (HasFields<T>) {
    const auto in_each = [&](const auto&... f) { return (all_finite(value.*(f.member)) && ...); };
    return std::apply(in_each, Described<T>::fields());
  } else if constexpr (requires { value.begin() != value.end(); }) {
    using Item = std::remove_cvref_t<decltype(*value.begin())>;
    if constexpr (std::floating_point<Item> || std::is_class_v<Item>) {
      for (const Item& item : value) {
        if (!all_finite(item)) return false;
      }
    }
    return true;
  } else {
    return true;
  }
}

}  // namespace mauve::detail
