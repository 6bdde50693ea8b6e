// SPDX-License-Identifier: LGPL-3.0-or-later
/// Property: a typed configuration value of a shell, core, fsm or interface (paper 3.3.1), and
/// Parameters: a plain struct of an algorithm whose fields are properties.
#pragma once

#include <memory>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <mauve/detail/declared.h>
#include <mauve/detail/property_base.h>

namespace mauve {

/// A value that the architecture file and `mauvectl set` give. Declared as a member. It changes
/// only while its element is not configured: a change of a running component makes a new element
/// beside it. Reading is [any]; real-time code reads it as a plain value. A core that hands many of
/// them to its algorithm in a struct declares that struct instead: Parameters.
/// @snippet api_examples.cpp Property
template <typename T>
class Property final : public detail::PropertyAt<T> {
 public:
  /// `text` describes the value for people; texts are literals.
  Property(Configurable& owner, std::string_view name, T value, std::string_view text = {},
           Limits<T> limits = {})
      : detail::PropertyAt<T>(owner, name, text, value, value_, std::move(limits)),
        value_(std::move(value)) {}
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
    if (Status done = this->set_typed(std::move(value)); !done) this->defer(done.error());
    return *this;
  }

 private:
  T value_;
};

/// One field of a struct of parameters; made by parameter().
template <typename Owner, typename T>
struct Parameter {
  std::string_view name;  ///< of the property
  T Owner::*member;       ///< holds its value
  std::string_view text;  ///< for people
  Limits<T> limits;       ///< and unit
};

/// A field as a property. Name and texts are literals.
template <typename Owner, typename T>
constexpr Parameter<Owner, T> parameter(std::string_view name, T Owner::*member,
                                        std::string_view text = {},
                                        Limits<std::type_identity_t<T>> limits = {}) {
  return {name, member, text, std::move(limits)};
}

namespace detail {

/// The property of one field.
template <typename T>
class FieldProperty final : public PropertyAt<T> {
 public:
  template <typename Owner>
  FieldProperty(Configurable& owner, const Parameter<Owner, T>& field, T& place)
      : PropertyAt<T>(owner, field.name, field.text, place, place, field.limits) {}
  using PropertyAt<T>::defer;
};

template <typename T>
inline constexpr bool kListsParameters = requires {
  T::parameters();
};

}  // namespace detail

/// A struct whose fields are set like properties. Declared as a member of a core, shell, state
/// machine or interface, and read as `gains->kp` or `*gains`. Each field that `T::parameters()`
/// lists is a property of the element under its name (`control.core.kp`), in that order; another
/// field keeps its value. As of any property, the values change only while the element is not
/// configured: a job sees one set of them. Reading is [any].
/// @snippet api_examples.cpp Parameters
template <typename T>
class Parameters {
  static_assert(detail::kListsParameters<T>,
                "mauve: a struct of parameters lists its fields: `static auto parameters() { "
                "return std::tuple{mauve::parameter(\"kp\", &Gains::kp)}; }`");

 public:
  /// `initial` holds the defaults of the properties.
  explicit Parameters(Configurable& owner, T initial = T{}) : values_(std::move(initial)) {
    std::apply([&](const auto&... fields) { (add(owner, fields), ...); }, T::parameters());
  }
  Parameters(const Parameters&) = delete;
  Parameters& operator=(const Parameters&) = delete;

  operator const T&() const { return values_; }           ///< [any]
  [[nodiscard]] const T& get() const { return values_; }  ///< [any]
  const T& operator*() const { return values_; }          ///< [any]
  const T* operator->() const { return &values_; }        ///< [any]

  /// In code: `core.gains = {.kp = 2.0}`. If one of the fields is refused (element configured, out
  /// of range), all keep their values, and the element's next configure() reports it.
  Parameters& operator=(T values) {
    bool good = true;
    each([&](const auto& field, auto& property) {
      Status done = good ? property.check(values.*(field.member)) : ok();
      if (done) return;
      good = false;
      property.defer(std::move(done.error()));
    });
    if (good) values_ = std::move(values);
    return *this;
  }

  /// The property of a listed field, for an error that names it:
  /// `return mauve::invalid(gains[&Gains::kp], "must not be below ki");`
  /// Throws for another field, which refuses the element in whose hook it happens.
  template <typename Owner, typename F>
  const PropertyBase& operator[](F Owner::*member) const {
    const PropertyBase* found = nullptr;
    each([&](const auto& field, const PropertyBase& property) {
      if (same(field.member, member)) found = &property;
    });
    if (found == nullptr) throw std::invalid_argument("this field is no listed parameter");
    return *found;
  }

 private:
  template <typename Owner, typename F>
  void add(Configurable& owner, const Parameter<Owner, F>& field) {
    properties_.push_back(
        std::make_unique<detail::FieldProperty<F>>(owner, field, values_.*(field.member)));
  }
  template <typename Member>
  static bool same(Member a, Member b) {
    return a == b;
  }
  template <typename Member, typename Other>
  static bool same(Member, Other) {
    return false;
  }
  /// Calls visit(field, its property) in the order of the list.
  template <typename Visit>
  void each(const Visit& visit) const {
    auto next = properties_.begin();
    const auto one = [&]<typename Owner, typename F>(const Parameter<Owner, F>& field) {
      visit(field, static_cast<detail::FieldProperty<F>&>(**next++));
    };
    std::apply([&](const auto&... fields) { (one(fields), ...); }, T::parameters());
  }

  T values_;
  std::vector<std::unique_ptr<PropertyBase>> properties_;  // as listed
};

}  // namespace mauve
