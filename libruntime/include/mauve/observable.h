// SPDX-License-Identifier: LGPL-3.0-or-later
/// Observable: a read-only value that a core shows, such as a counter (`gnss.core.bad_frames`).
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include <mauve/detail/configurable.h>
#include <mauve/type.h>

namespace mauve {

/// What the runtime sees of an observable.
class ObservableBase {
 public:
  ObservableBase(const ObservableBase&) = delete;
  ObservableBase& operator=(const ObservableBase&) = delete;
  virtual ~ObservableBase() = default;

  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] std::string_view unit() const { return unit_; }
  [[nodiscard]] std::string address() const;
  [[nodiscard]] const DataType& type() const { return *type_; }
  [[nodiscard]] virtual Value value() const = 0;
  /// Takes over the value of the same observable of a predecessor. [rt] at a swap, bounded.
  void continue_from(const ObservableBase& other) {
    bits_.store(other.bits_.load(std::memory_order_relaxed), std::memory_order_relaxed);
  }

 protected:
  ObservableBase(Configurable& owner, std::string_view name, std::string_view text,
                 std::string_view unit, const DataType& type);
  std::atomic<std::uint64_t> bits_{0};

 private:
  Configurable& owner_;
  std::string_view name_;
  std::string_view text_;
  std::string_view unit_;
  const DataType* type_;
};

/// Declared as a member: `mauve::Observable<int> bad_frames{*this, "bad_frames", 0, "refused"};`
/// With a unit: `mauve::Observable<double> sigma{*this, "sigma", 0.0, "of the place", "m"};`
/// Written by the component's own thread ([rt], wait-free), read by anyone.
template <typename T>
class Observable final : public ObservableBase {
  static_assert(std::is_arithmetic_v<T>, "an observable is a number or a boolean");

 public:
  Observable(Configurable& owner, std::string_view name, T value = {}, std::string_view text = {},
             std::string_view unit = {})
      : ObservableBase(owner, name, text, unit, data_type<T>()) {
    *this = value;
  }

  [[nodiscard]] T get() const { return unpack(bits_.load(std::memory_order_relaxed)); }
  operator T() const { return get(); }
  Observable& operator=(T value) {
    bits_.store(pack(value), std::memory_order_relaxed);
    return *this;
  }
  Observable& operator+=(T value) { return *this = static_cast<T>(get() + value); }
  Observable& operator++() { return *this += T{1}; }

  [[nodiscard]] Value value() const override { return Codec<T>::encode(get()); }

 private:
  static std::uint64_t pack(T value) {
    std::uint64_t bits = 0;
    __builtin_memcpy(&bits, &value, sizeof value);
    return bits;
  }
  static T unpack(std::uint64_t bits) {
    T value;
    __builtin_memcpy(&value, &bits, sizeof value);
    return value;
  }
};

}  // namespace mauve
