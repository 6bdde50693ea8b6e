// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a read found, and what ports and services compare before they are connected.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <mauve/time.h>
#include <mauve/type.h>

namespace mauve {

/// Result of a read.
enum class DataStatus : std::uint8_t {
  no_data,    ///< never written, or the port is not connected: the port's default was returned
  old_data,   ///< the value read before
  new_data,   ///< written since the last read
  stale,      ///< older than the port's max_age; the value is delivered
  timed_out,  ///< the resource was busy beyond the caller's bound: the default was returned
  poisoned,   ///< a caller crashed inside the resource, see Gate::poison: the default was returned
};

[[nodiscard]] std::string_view to_string(DataStatus status);

/// Did the read deliver a value?
[[nodiscard]] constexpr bool has_value(DataStatus status) {
  return status == DataStatus::old_data || status == DataStatus::new_data ||
         status == DataStatus::stale;
}

/// Where one reader stands with one service.
struct Cursor {
  unsigned slot = 0;       ///< reader slot of a wait-free exchange
  std::uint64_t seen = 0;  ///< sequence number of the last value read
  Instant stamp = 0;       ///< when the value read was written (start of the writing job)
  /// The value itself, held still, in an exchange in which the reader has a place of its own.
  const void* data = nullptr;
  static constexpr std::uint64_t kNone = ~0ULL;
  std::uint64_t word = kNone;  ///< of that exchange; the same: `data` is still its newest value
};

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

/// A borrowed callable `void(const void*)`; lives for one call.
class Visitor {
 public:
  template <typename F>
  Visitor(F& f)
      : object_(&f),
        call_([](void* object, const void* data) { (*static_cast<F*>(object))(data); }) {}
  void operator()(const void* data) const { call_(object_, data); }

 private:
  void* object_;
  void (*call_)(void*, const void*);
};

/// A borrowed callable `void(void*)`.
class Filler {
 public:
  template <typename F>
  Filler(F& f)
      : object_(&f), call_([](void* object, void* data) { (*static_cast<F*>(object))(data); }) {}
  void operator()(void* data) const { call_(object_, data); }

 private:
  void* object_;
  void (*call_)(void*, void*);
};

}  // namespace mauve
