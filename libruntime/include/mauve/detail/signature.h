// SPDX-License-Identifier: LGPL-3.0-or-later
/// The properties of ports and services that are compared before they are connected.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <mauve/type.h>

namespace mauve {

enum class PortKind : std::uint8_t { read, write, call, event };

[[nodiscard]] std::string_view to_string(PortKind kind);

/// Kind and types of a port or service. Equal signatures may be connected.
struct Signature {
  PortKind kind = PortKind::read;
  std::string types;               ///< "laser_scan/1", "motion_state/1(double)", "()"
  std::uint64_t layout = 0;        ///< all layouts together
  const DataType* data = nullptr;  ///< of read and write; lives with the library of the element
  std::vector<const DataType*> arguments = {};  ///< of call and event, in their order
  const DataType* result = nullptr;             ///< of call

  template <typename T>
  static Signature read() {
    return {PortKind::read, data_type<T>().name, data_type<T>().layout, &data_type<T>()};
  }
  template <typename T>
  static Signature write() {
    return {PortKind::write, data_type<T>().name, data_type<T>().layout, &data_type<T>()};
  }
  template <typename R, typename... P>
  static Signature call() {
    Signature signature = event<P...>();
    signature.kind = PortKind::call;
    signature.types = data_type<R>().name + signature.types;
    signature.result = &data_type<R>();
    signature.layout = detail::hash(data_type<R>().layout, signature.layout);
    return signature;
  }
  template <typename... P>
  static Signature event() {
    Signature signature{PortKind::event, "", detail::kHashSeed, nullptr};
    ((signature.types +=
      (signature.types.empty() ? "" : ", ") + data_type<std::remove_cvref_t<P>>().name,
      signature.layout =
          detail::hash(data_type<std::remove_cvref_t<P>>().layout, signature.layout)),
     ...);
    signature.types = "(" + signature.types + ")";
    signature.arguments = {&data_type<std::remove_cvref_t<P>>()...};
    return signature;
  }

  friend bool operator==(const Signature& a, const Signature& b) {
    return a.kind == b.kind && a.layout == b.layout && a.types == b.types;
  }
};

/// "read laser_scan/1"
[[nodiscard]] std::string to_string(const Signature& signature);

/// How many ports may be connected to a service at once. `one`: it moves something, and two that
/// command it would contradict each other; a second one is refused.
enum class Writers : std::uint8_t { many, one };

}  // namespace mauve
