// SPDX-License-Identifier: LGPL-3.0-or-later
/// Described data types: one description gives JSON, recording, layout check and hand-over.
///
///   struct Velocity {
///     double linear = 0.0;
///     double angular = 0.0;
///
///     static constexpr std::string_view type_name = "velocity/1";
///     static constexpr auto fields() {
///       return std::tuple{mauve::field("linear", &Velocity::linear, "m/s"),
///                         mauve::field("angular", &Velocity::angular, "rad/s")};
///     }
///   };
///
/// The number after the name is the revision of the type. A struct that you cannot change, such as
/// that of a library, is described beside it, with `name` in place of `type_name`:
///
///   template <> struct mauve::Described<Eigen::Vector2d> {
///     static constexpr std::string_view name = "vector2d/1";
///     ...
///
/// A field has one of these types, shown with its JSON. `T` is one of them again:
///
/// | type of the field                 | JSON                             |
/// |-----------------------------------|----------------------------------|
/// | `bool`                            | `true`                           |
/// | `std::int8_t` ... `std::int64_t`  | `-3`                             |
/// | `std::uint8_t` ... `std::uint64_t`| `3`                              |
/// | `float`, `double`                 | `0.5`, `"nan"`, `"inf"`, `"-inf"`|
/// | `mauve::Duration`                 | `"10ms"`                         |
/// | `mauve::Text<N>`                  | `"left"`                         |
/// | `std::array<T, N>`                | `[1, 2, 3]`                      |
/// | `mauve::Bounded<T, N>`            | `[1, 2]`                         |
/// | a struct with `fields()`          | `{"x": 1, "y": 2}`               |
///
/// A text has at most N bytes, an array has N items, and a
/// Bounded has at most N. Other types do not compile, such as an enumeration (write a
/// `std::int32_t`), `char`, `long double`, a pointer, `double[3]` or `std::vector`. Properties may
/// also hold a `std::string` of at most 4096 bytes, but a value with one has no fixed size, and no
/// resource exchanges it.
///
/// fields() of an aggregate has each of its members, or none (`return std::tuple{};`): then the
/// type is opaque to tools, and its author raises the revision with each change. Members of a
/// struct that has a constructor, a base class or a private member are not counted.
///
/// A type that cannot be described field by field may have a name alone, without fields(): its
/// author vouches that all builds of that revision lay it out alike. A type with neither counts
/// as the same in code of one build only.
///
/// A type that replaces an older one may declare a conversion from it. Its author keeps the older
/// type beside the new one, under its old description. Then shared_data and ring_buffer keep their
/// values when a change gives them the new type:
///
///     using Before = VelocityV1;
///     static void convert(const VelocityV1& old, Velocity& now) noexcept;
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <typeinfo>

#include <mauve/detail/codec.h>
#include <mauve/host/value.h>
#include <mauve/result.h>

namespace mauve {

/// The description of a type at run time. Two plugins mean the same type when name and layout are
/// equal. Lives as long as the library that instantiated it.
struct DataType {
  std::string name;           ///< "velocity/1", "double", or a compiler's name when not described
  std::size_t size = 0;       ///< bytes
  std::size_t alignment = 0;  ///< bytes
  /// Hash of names, kinds, offsets and sizes of all fields; of a type without description: of its
  /// size, its name and the build of its plugin.
  std::uint64_t layout = 0;
  bool vouched = true;  ///< described, or named by its author: same in all builds of a revision
  bool flat = false;    ///< trivially copyable: may be exchanged as bytes
  Value (*to_value)(const void* data) = nullptr;                   ///< null: not described
  Status (*from_value)(const Value& value, void* data) = nullptr;  ///< null: not described
  Value (*describe)() = nullptr;              ///< fields with kinds and units, for people and tools
  void (*construct)(void* memory) = nullptr;  ///< default value; null for void
  /// The older type whose values convert() turns into values of this one; null: none. `now` is a
  /// default value.
  const DataType& (*before)() = nullptr;
  void (*convert)(const void* old, void* now) = nullptr;  ///< null with before
};

/// Equal name and layout.
[[nodiscard]] inline bool same_type(const DataType& a, const DataType& b) {
  return a.layout == b.layout && a.name == b.name;
}

/// The description of T. [any], not on a real-time thread.
template <typename T>
[[nodiscard]] const DataType& data_type();

// --- implementation ------------------------------------------------------------------------

namespace detail {

inline constexpr std::uint64_t kHashSeed = 0xcbf29ce484222325ULL;

/// FNV-1a.
constexpr std::uint64_t hash(std::string_view text, std::uint64_t seed = kHashSeed) {
  for (const char c : text) seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return seed;
}
constexpr std::uint64_t hash(std::uint64_t number, std::uint64_t seed) {
  for (int i = 0; i < 8; ++i, number >>= 8) seed = (seed ^ (number & 0xff)) * 0x100000001b3ULL;
  return seed;
}

/// The build of the plugin that this code belongs to (the checksum of its file), set before it
/// declares anything; 0: the program. Each plugin has its own.
inline std::uint64_t this_build __attribute__((visibility("hidden"))) = 0;

/// Is the layout of T known from its description, or by the word of its author?
template <typename T>
inline constexpr bool kVouched = HasCodec<T> || HasName<T>;

template <typename T>
std::uint64_t layout_of() {
  std::uint64_t h = hash(sizeof(T), hash(alignof(T), kHashSeed));
  if constexpr (HasGoodFields<T>) {
    static_assert(kDescribesAll<T>,
                  "mauve: fields() of a described type T has a field for each member of T, since "
                  "a changed layout of the others would not be noticed");
    const T sample{};
    const auto* base = reinterpret_cast<const std::byte*>(&sample);
    std::apply(
        [&](const auto&... f) {
          ((h = hash(f.name, h),
            h = hash(static_cast<std::uint64_t>(
                         reinterpret_cast<const std::byte*>(&(sample.*(f.member))) - base),
                     h),
            h = hash(data_type<std::remove_cvref_t<decltype(sample.*(f.member))>>().layout, h)),
           ...);
        },
        Described<T>::fields());
  } else {
    h = hash(std::string_view(type_name<T>()), h);
    if constexpr (!kVouched<T>) h = hash(this_build, h);
  }
  return h;
}

/// The description makes T from Before without an exception, and both are plain bytes.
template <typename T, typename Before>
inline constexpr bool kConvertsFrom = std::is_trivially_copyable_v<T>&&
    std::is_trivially_copyable_v<Before>&& requires(const Before& old, T& now) {
  { Described<T>::convert(old, now) }
  noexcept;
};

template <typename T>
DataType make_data_type() {
  DataType type;
  type.name = type_name<T>();
  if constexpr (!std::is_void_v<T>) {
    type.size = sizeof(T);
    type.alignment = alignof(T);
    type.layout = layout_of<T>();
    type.vouched = kVouched<T>;
    type.flat = std::is_trivially_copyable_v<T>;
    constexpr bool kMade = std::is_default_constructible_v<T>;
    static_assert(kMade, "mauve: a data type has a default value: a constructor without arguments");
    if constexpr (kMade) type.construct = [](void* memory) { ::new (memory) T{}; };
    if constexpr (requires { typename Described<T>::Before; }) {
      using Before = typename Described<T>::Before;
      static_assert(
          kConvertsFrom<T, Before>,
          "mauve: the description of a type T with `using Before = Old;` has a `static "
          "void convert(const Old& old, T& now) noexcept`, and both types are plain bytes");
      if constexpr (kConvertsFrom<T, Before>) {
        type.before = &data_type<Before>;
        type.convert = [](const void* old, void* now) {
          Described<T>::convert(*static_cast<const Before*>(old), *static_cast<T*>(now));
        };
      }
    }
    if constexpr (HasCodec<T>) {
      type.to_value = [](const void* data) {
        return Codec<T>::encode(*static_cast<const T*>(data));
      };
      type.from_value = [](const Value& value, void* data) {
        return Codec<T>::decode(value, *static_cast<T*>(data));
      };
      type.describe = [] { return Codec<T>::describe(); };
    }
  }
  return type;
}

}  // namespace detail

template <typename T>
const DataType& data_type() {
  static const DataType type = detail::make_data_type<T>();
  return type;
}

}  // namespace mauve
