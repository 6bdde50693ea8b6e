// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ports that call a method of a resource: CallPort with an answer, EventPort without one.
#pragma once

#include <optional>
#include <string_view>
#include <type_traits>

#include <mauve/detail/declared.h>
#include <mauve/detail/port_base.h>
#include <mauve/service.h>

namespace mauve {

/// Of a signature `R(P...)`, see its specialization.
template <typename Signature>
class CallPort {
  static_assert(detail::kNever<Signature>,
                "mauve: a call port has a signature such as `CallPort<double(int)>`");

 public:
  /// Accepts any arguments, so that the sentence above is the only error.
  template <typename... A>
  explicit CallPort(A&&...) {}
};

/// Calls a connected service: `std::optional<MotionState> s = shell().predict_at(0.1);`, empty
/// when nothing answers. For R = void it returns whether it was called. The method runs on the
/// thread of the caller.
/// @snippet api_examples.cpp CallPort
template <typename R, typename... P>
class CallPort<R(P...)> final : public PortBase {
 public:
  /// Registers itself with the shell.
  CallPort(Shell& shell, std::string_view name, Need need = Need::usual)
      : PortBase(shell, name, mauve::Signature::call<R, P...>(), need) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<2, detail::Types<Shell&, std::string_view, Need>,
                              Wrong...>) explicit CallPort(Wrong&&...)
      : CallPort(detail::none<Shell&>(), {}) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: a call port is a member of a shell, declared as `CallPort<R(P...)> "
                  "NAME{*this, \"NAME\"};`");
  }

  /// Calls on this thread, under the resource lock. Empty or false: not connected, no lock in time,
  /// or a poisoned resource. [rt]
  auto operator()(std::remove_cvref_t<P>... arguments) {
    void* pointers[sizeof...(P) + 1] = {&arguments..., nullptr};
    const TracedCall call = call_begins();
    const Binding* connection = binding();
    if constexpr (std::is_void_v<R>) {
      const bool done = connection != nullptr && connection->service().invoke(nullptr, pointers);
      if (!done) count_failure();
      return call.ended(done);
    } else {
      std::optional<R> result{std::in_place};
      if (connection == nullptr || !connection->service().invoke(&*result, pointers)) {
        count_failure();
        result.reset();
      }
      call.ended(result.has_value());
      return result;
    }
  }
};

/// Triggers an action of a connected service; not connected: nothing happens.
/// @snippet api_examples.cpp EventPort
template <typename... P>
class EventPort final : public PortBase {
 public:
  /// Registers itself with the shell.
  EventPort(Shell& shell, std::string_view name, Need need = Need::usual)
      : PortBase(shell, name, Signature::event<P...>(), need) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kDeclares<2, detail::Types<Shell&, std::string_view, Need>,
                              Wrong...>) explicit EventPort(Wrong&&...)
      : EventPort(detail::none<Shell&>(), {}) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: an event port is a member of a shell, declared as `EventPort<P...> "
                  "NAME{*this, \"NAME\"};`");
  }

  /// False: nothing was triggered, for the same reasons as a call. [rt]
  bool operator()(std::remove_cvref_t<P>... arguments) {
    void* pointers[sizeof...(P) + 1] = {&arguments..., nullptr};
    const TracedCall call = call_begins();
    const Binding* connection = binding();
    const bool done = connection != nullptr && connection->service().invoke(nullptr, pointers);
    if (!done) count_failure();
    return call.ended(done);
  }
};

}  // namespace mauve
