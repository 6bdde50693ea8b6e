// SPDX-License-Identifier: LGPL-3.0-or-later
/// Property: a typed configuration value of a shell, core, fsm or interface (paper 3.3.1).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <mauve/detail/configurable.h>
#include <mauve/detail/declared.h>
#include <mauve/type.h>

namespace mauve {

/// Optional limits and unit of a property: `{.unit = "m/s", .min = 0.0, .max = 2.0}`.
template <typename T>
struct Limits {
  std::string_view unit = {};  ///< for people, such as "m/s"
  std::optional<T> min = {};   ///< the smallest value; empty: none
  std::optional<T> max = {};   ///< the largest value; empty: none
  /// Of a path: where it must lie when a request sets it, as words with spaces between them.
  /// "/dev/" is a directory, "./" that of the architecture, and "pty:" the beginning of a name that
  /// has no slash. Every property whose value is opened or created as a file declares this. The
  /// architecture file itself may name any path.
  std::string_view within = {};
};

/// The base class of properties of all types, through which the runtime uses them.
class PropertyBase {
 public:
  PropertyBase(const PropertyBase&) = delete;
  PropertyBase& operator=(const PropertyBase&) = delete;
  virtual ~PropertyBase() = default;

  [[nodiscard]] std::string_view name() const { return name_; }  ///< of the member
  [[nodiscard]] std::string_view text() const { return text_; }  ///< for people
  [[nodiscard]] std::string_view unit() const { return unit_; }  ///< may be empty
  [[nodiscard]] std::string address() const;                     ///< such as "control.core.gain"
  [[nodiscard]] const DataType& type() const { return *type_; }  ///< of the value

  /// Values as text-like trees; null where there is none (no limit, type without description).
  [[nodiscard]] virtual Value value() const = 0;
  [[nodiscard]] virtual Value default_value() const = 0;  ///< as declared
  [[nodiscard]] virtual Value min() const { return {}; }  ///< null: none
  [[nodiscard]] virtual Value max() const { return {}; }  ///< null: none
  /// Where a path must lie that a request sets, see Limits; empty: this is no path.
  [[nodiscard]] virtual std::string_view within() const { return {}; }

  /// Writes the value; refused when the element is configured, of another type, out of range.
  /// [control] or [factory].
  Status set(const Value& value);
  /// Would set() accept this value (apart from being configured)?
  [[nodiscard]] virtual Status accepts(const Value& value) const = 0;

 protected:
  /// Registers itself with its owner.
  PropertyBase(Configurable& owner, std::string_view name, std::string_view text,
               std::string_view unit, const DataType& type);
  /// An error when the owner is configured.
  [[nodiscard]] Status writable() const;
  /// Keeps an error for the owner's next configure().
  void defer(Error error);
  virtual Status assign(const Value& value) = 0;  ///< converts, checks and stores the value

 private:
  Configurable& owner_;
  std::string_view name_;
  std::string_view text_;
  std::string_view unit_;
  const DataType* type_;
};

/// A value that the architecture file and `mauvectl set` give. Declared as a member. It changes
/// only while its element is not configured: a change of a running component makes a new element
/// beside it. Reading is [any]; real-time code reads it as a plain value.
/// @snippet api_examples.cpp Property
template <typename T>
class Property final : public PropertyBase {
  static_assert(detail::HasCodec<T>,
                "mauve: the type of a property is a bool, a number, std::string, mauve::Duration, "
                "mauve::Text, an array of these, or a struct with a mauve::Described");

 public:
  /// `text` says for people what it is; texts are literals.
  Property(Configurable& owner, std::string_view name, T value, std::string_view text = {},
           Limits<T> limits = {})
      : PropertyBase(owner, name, text, limits.unit, data_type<T>()),
        default_(value),
        value_(std::move(value)),
        limits_(std::move(limits)) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<
           3, detail::Types<Configurable&, std::string_view, T, std::string_view, Limits<T>>,
           Wrong...>) explicit Property(Wrong&&...)
      : Property(detail::none<Configurable&>(), {}, detail::none<T>()) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: a property is declared as `Property<T> NAME{*this, \"NAME\", DEFAULT, "
                  "\"text\"};` with a default of its type");
  }

  operator const T&() const { return value_; }           ///< [any]
  [[nodiscard]] const T& get() const { return value_; }  ///< [any]
  const T& operator*() const { return value_; }          ///< [any]
  const T* operator->() const { return &value_; }        ///< [any]

  /// In code: `shell().device = "/dev/ttyS0"`. A refused value (element configured, out of range)
  /// changes nothing and is reported by the element's next configure().
  Property& operator=(T value) {
    if (Status done = set_typed(std::move(value)); !done) defer(done.error());
    return *this;
  }
  /// The same with the answer at once.
  Status set_typed(T value) {
    if (Status done = writable(); !done) return done;
    if (Status done = in_range(value); !done) return done;
    value_ = std::move(value);
    return ok();
  }

  [[nodiscard]] Value value() const override { return encode(value_); }
  /// See PropertyBase.
  [[nodiscard]] Value default_value() const override { return encode(default_); }
  /// See PropertyBase.
  [[nodiscard]] Value min() const override { return limits_.min ? encode(*limits_.min) : Value(); }
  /// See PropertyBase.
  [[nodiscard]] Value max() const override { return limits_.max ? encode(*limits_.max) : Value(); }
  [[nodiscard]] std::string_view within() const override { return limits_.within; }
  [[nodiscard]] Status accepts(const Value& value) const override {
    T decoded = default_;
    return decode(value, decoded);
  }

 protected:
  /// See PropertyBase.
  Status assign(const Value& value) override {
    T decoded = value_;
    if (Status done = decode(value, decoded); !done) return done;
    value_ = std::move(decoded);
    return ok();
  }

 private:
  static Value encode(const T& data) { return Codec<T>::encode(data); }
  Status decode(const Value& value, T& data) const {
    Status done = Codec<T>::decode(value, data);
    return done ? in_range(data) : detail::inside(std::move(done), address());
  }
  Status in_range([[maybe_unused]] const T& value) const {
    if constexpr (requires { value < value; }) {
      if (limits_.min && value < *limits_.min)
        return beyond(value, "below the minimum ", *limits_.min);
      if (limits_.max && *limits_.max < value)
        return beyond(value, "above the maximum ", *limits_.max);
      if constexpr (std::is_floating_point_v<T>) {
        if (value != value)
          return refuse({Errc::invalid_value, "value_out_of_range"}, address(), "is not a number");
      }
    }
    return ok();
  }
  Error beyond(const T& value, const char* relation, const T& limit) const {
    return refuse({Errc::invalid_value, "value_out_of_range"}, address(),
                  to_string(encode(value)) + " is " + relation + to_string(encode(limit)) +
                      (unit().empty() ? "" : " " + std::string(unit())));
  }

  T default_;
  T value_;
  Limits<T> limits_;
};

/// An error that names the property: `return mauve::invalid(gain, "must be positive");`
[[nodiscard]] Error invalid(const PropertyBase& property, std::string message);

}  // namespace mauve
