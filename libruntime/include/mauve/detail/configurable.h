// SPDX-License-Identifier: LGPL-3.0-or-later
/// Configurable: the base class of every shell, core, fsm and interface (paper 3.2).
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <mauve/result.h>

namespace mauve {

class CoreBase;
class PropertyBase;
class ObservableBase;

/// An element that is either configured or not. Properties are written only while it is not.
/// Authors derive from it, so a virtual function is a hook, or its name begins with `mauve_`.
class Configurable {
 public:
  Configurable() = default;
  Configurable(const Configurable&) = delete;
  Configurable& operator=(const Configurable&) = delete;
  virtual ~Configurable() = default;

  /// Dotted address, such as "control.core". Empty until a component or resource adopts it.
  [[nodiscard]] const std::string& address() const { return address_; }
  /// Between configure() and cleanup().
  [[nodiscard]] bool configured() const { return configured_.load(std::memory_order_acquire); }

  /// Calls on_configure(), then checks the element. An exception of the hook becomes an Error.
  /// Already configured: nothing happens. [control] or [factory], never a real-time thread.
  Status configure();
  /// Calls on_cleanup() when configured. An exception of the hook is swallowed and returned.
  Status cleanup();
  /// Runtime only: on_cleanup() did not end, so the element must not be destroyed: a thread of it
  /// may still run, or not be joined.
  [[nodiscard]] bool mauve_is_unclean() const { return unclean_; }

  /// In the order of declaration.
  [[nodiscard]] const std::vector<PropertyBase*>& properties() const { return properties_; }
  /// In the order of declaration.
  [[nodiscard]] const std::vector<ObservableBase*>& observables() const { return observables_; }
  [[nodiscard]] PropertyBase* find_property(std::string_view name) const;  ///< null: there is none
  /// null: there is none
  [[nodiscard]] ObservableBase* find_observable(std::string_view name) const;

  /// Runtime only: gives the element its address, and reports it to the observer. [factory]
  void adopt(std::string address);
  /// Runtime only: `notify` is called with each address that the element is given; set before the
  /// first.
  void when_adopted(std::function<void(const std::string& address)> notify) {
    given_address_ = std::move(notify);
  }

 protected:
  /// Called by configure(): open, allocate, compute; return an error to refuse. [factory]
  virtual Status on_configure() { return ok(); }
  /// Called by cleanup(): undo on_configure(), close and free. [factory]
  virtual void on_cleanup() {}
  /// Runtime only: undoes the declarations of an earlier on_configure(), before it is called again.
  virtual void mauve_reset() {}
  /// Runtime only: checks the declarations of on_configure().
  virtual Status mauve_verify() { return ok(); }

 private:
  friend class PropertyBase;
  friend class ObservableBase;
  friend class Connected;

  std::string address_;
  std::function<void(const std::string& address)> given_address_;
  std::atomic<bool> configured_{false};
  bool unclean_ = false;
  std::optional<Error> pending_error_;  // a refused value or connection, reported by configure()
  std::vector<PropertyBase*> properties_;
  std::vector<ObservableBase*> observables_;
};

namespace detail {

/// Whether the runtime calls what T declares under the name of a hook: another signature hides the
/// hook, so nobody would call either. The private methods of T are not seen, nor are the protected
/// ones of a final class.
template <typename T>
struct HooksOf : std::conditional_t<std::is_final_v<T>, std::true_type, T> {
  template <typename H = std::conditional_t<std::is_final_v<T>, T, HooksOf>>
  static constexpr bool are_called() {
    constexpr bool kConfigure = requires { &H::on_configure; };
    constexpr bool kCleanup = requires { &H::on_cleanup; };
    constexpr bool kStop = std::is_base_of_v<CoreBase, T> && requires { &H::on_stop; };
    constexpr bool kConfigures = requires { static_cast<Status (H::*)()>(&H::on_configure); };
    constexpr bool kCleans = requires { static_cast<void (H::*)()>(&H::on_cleanup); };
    constexpr bool kStops = requires { static_cast<void (H::*)()>(&H::on_stop); };
    return (kConfigures || !kConfigure) && (kCleans || !kCleanup) && (kStops || !kStop);
  }
};

}  // namespace detail
}  // namespace mauve
