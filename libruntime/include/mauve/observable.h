// SPDX-License-Identifier: LGPL-3.0-or-later
/// Observable: a read-only value that a core shows, such as a counter (`gnss.core.bad_frames`), and
/// Warning, a condition that lasts.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include <mauve/detail/configurable.h>
#include <mauve/detail/declared.h>
#include <mauve/job.h>
#include <mauve/log.h>
#include <mauve/time.h>
#include <mauve/type.h>

namespace mauve {

/// The base class of observables, through which the runtime uses them.
class ObservableBase {
 public:
  ObservableBase(const ObservableBase&) = delete;
  ObservableBase& operator=(const ObservableBase&) = delete;
  virtual ~ObservableBase() = default;

  [[nodiscard]] std::string_view name() const { return name_; }  ///< of the member
  [[nodiscard]] std::string_view text() const { return text_; }  ///< for people
  [[nodiscard]] std::string_view unit() const { return unit_; }  ///< may be empty
  [[nodiscard]] std::string address() const;                     ///< such as "gnss.core.bad_frames"
  [[nodiscard]] const DataType& type() const { return *type_; }  ///< of the value
  [[nodiscard]] virtual Value value() const = 0;                 ///< the value now [any but rt]
  /// When the value was written last, be it the same again, as a job_time(); 0: never. [any]
  [[nodiscard]] Instant written() const { return written_.load(std::memory_order_relaxed); }
  /// Takes over the value of the same observable of a predecessor. [rt] at a swap, bounded.
  void continue_from(const ObservableBase& other) {
    bits_.store(other.bits_.load(std::memory_order_relaxed), std::memory_order_relaxed);
    written_.store(other.written(), std::memory_order_relaxed);
  }

 protected:
  /// Registers itself with its owner.
  ObservableBase(Configurable& owner, std::string_view name, std::string_view text,
                 std::string_view unit, const DataType& type);
  std::atomic<std::uint64_t> bits_{0};  ///< the bytes of the value
  std::atomic<Instant> written_{0};     ///< see written()

 private:
  Configurable& owner_;
  std::string_view name_;
  std::string_view text_;
  std::string_view unit_;
  const DataType* type_;
};

/// A number or a boolean that a core shows to people, rules and tools. Declared as a member.
/// Written by the component's own thread ([rt], wait-free), read by any thread. A swap continues
/// the value of the observable of the same name and type, and its age. The age is the time since it
/// was written last, be it the same value again (`gnss.core.satellites.age` in a condition).
/// @snippet api_examples.cpp Observable
template <typename T>
class Observable final : public ObservableBase {
  static_assert(std::is_arithmetic_v<T> && detail::HasCodec<T>,
                "mauve: an observable is a number or a boolean");

 public:
  /// `text` describes the value for people, `unit` is its unit; both are literals.
  Observable(Configurable& owner, std::string_view name, T value = {}, std::string_view text = {},
             std::string_view unit = {})
      : ObservableBase(owner, name, text, unit, data_type<T>()) {
    bits_.store(pack(value), std::memory_order_relaxed);
  }
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<
           2, detail::Types<Configurable&, std::string_view, T, std::string_view, std::string_view>,
           Wrong...>) explicit Observable(Wrong&&...)
      : Observable(detail::none<Configurable&>(), {}) {
    static_assert(
        detail::kNever<Wrong...>,
        "mauve: an observable is declared as `Observable<T> NAME{*this, \"NAME\"};`, then "
        "a value of its type, a text and a unit");
  }

  [[nodiscard]] T get() const { return unpack(bits_.load(std::memory_order_relaxed)); }  ///< [any]
  operator T() const { return get(); }                                                   ///< [any]
  /// [rt] by one thread, wait-free.
  Observable& operator=(T value) {
    bits_.store(pack(value), std::memory_order_relaxed);
    written_.store(job_time(), std::memory_order_relaxed);
    return *this;
  }
  /// As get() + value.
  Observable& operator+=(T value) { return *this = static_cast<T>(get() + value); }
  Observable& operator++() { return *this += T{1}; }  ///< as += 1

  /// See ObservableBase.
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

/// A condition of a core that lasts, with its reason, such as a device that is silent. The log has
/// one line when it begins and one when it ends, `mauvectl status` names it while it
/// lasts, and conditions read it as true or false (`imu.core.silent == true`). Declared as a
/// member. Written by the component's own thread ([rt], wait-free), read by any thread. A swap
/// continues it.
/// @snippet api_examples.cpp Warning
class Warning final : public ObservableBase {
 public:
  /// `text` describes the condition for people; both are literals.
  Warning(Configurable& owner, std::string_view name, std::string_view text = {});

  /// It lasts from now on. `reason` is a literal, which may show two arguments. While it lasts,
  /// another reason, or another argument, replaces the one that `status` shows, without a line in
  /// the log. [rt]
  template <std::size_t N>
  void begin(const char (&reason)[N], LogArgument a = {}, LogArgument b = {}) {
    keep(reason, a, b);
    if (change(true)) log(LogLevel::warning, reason, a, b);
  }
  /// It is over, as `said` tells the log. Nothing happens if it does not last. [rt]
  template <std::size_t N>
  void end(const char (&said)[N], LogArgument a = {}, LogArgument b = {}) {
    if (change(false)) log(LogLevel::info, said, a, b);
  }

  /// A thread that sees it last sees its reason and its time too. [any]
  [[nodiscard]] bool lasts() const { return bits_.load(std::memory_order_acquire) != 0; }
  /// With its arguments. Empty: the core before gave it. [any but rt]
  [[nodiscard]] std::string reason() const;
  /// True while it lasts. [any but rt]
  [[nodiscard]] Value value() const override;

 private:
  /// True: it was otherwise.
  bool change(bool lasts);
  void keep(const char* reason, const LogArgument& a, const LogArgument& b);

  /// A LogArgument that any thread may read while a job writes it.
  struct Argument {
    std::atomic<bool> is_number{false};
    std::atomic<std::int64_t> integer{0};
    std::atomic<double> number{0.0};
  };
  std::atomic<const char*> reason_{nullptr};
  Argument a_;
  Argument b_;
};

}  // namespace mauve
