// SPDX-License-Identifier: LGPL-3.0-or-later
/// PropertyBase, and a property whose value lies in memory of its owner. Authors include
/// property.h.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <mauve/detail/configurable.h>
#include <mauve/detail/plausible.h>
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

namespace detail {

/// A property whose value lies in memory of its owner.
template <typename T>
class PropertyAt : public PropertyBase {
  static_assert(HasCodec<T>,
                "mauve: the type of a property is a bool, a number, std::string, mauve::Duration, "
                "mauve::Text, an array of these, or a struct with type_name and fields()");

 public:
  /// As Property::operator=, with the answer at once.
  Status set_typed(T value) {
    Status done = check(value);
    if (done) place_ = std::move(value);
    return done;
  }
  /// Would set_typed() take the value?
  [[nodiscard]] Status check(const T& value) const {
    Status done = writable();
    return done ? in_range(value) : done;
  }

  [[nodiscard]] Value value() const override { return encode(place_); }
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
  /// Does not touch `place`, which may not be made yet; its owner gives it the value `initial`.
  PropertyAt(Configurable& owner, std::string_view name, std::string_view text, T initial, T& place,
             Limits<T> limits)
      : PropertyBase(owner, name, text, limits.unit, data_type<T>()),
        default_(std::move(initial)),
        place_(place),
        limits_(std::move(limits)) {}

  /// See PropertyBase.
  Status assign(const Value& value) override {
    T decoded = place_;
    if (Status done = decode(value, decoded); !done) return done;
    place_ = std::move(decoded);
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
    }
    if (!all_numbers(value, [](auto number) { return number == number; }))
      return refuse({Errc::invalid_value, "value_out_of_range"}, address(),
                    std::is_floating_point_v<T> ? "is not a number"
                                                : "has a field or an item that is not a number");
    return ok();
  }
  Error beyond(const T& value, const char* relation, const T& limit) const {
    return refuse({Errc::invalid_value, "value_out_of_range"}, address(),
                  to_string(encode(value)) + " is " + relation + to_string(encode(limit)) +
                      (unit().empty() ? "" : " " + std::string(unit())));
  }

  T default_;
  T& place_;
  Limits<T> limits_;
};

}  // namespace detail

/// An error that names the property: `return mauve::invalid(gain, "must be positive");`
[[nodiscard]] Error invalid(const PropertyBase& property, std::string message);

}  // namespace mauve
