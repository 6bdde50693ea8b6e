// SPDX-License-Identifier: LGPL-3.0-or-later
/// Method: a core's method bound by name, called through the core that is current.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include <mauve/host/version.h>

namespace mauve {

class CoreBase;

template <typename Signature>
class Method;

/// R (C::*)(P...) with C forgotten: state machines and services keep these, so that one core can
/// replace another. No heap; a call costs one indirect call more than the method itself.
template <typename R, typename... P>
class Method<R(P...)> {
 public:
  template <typename C>
  explicit Method(R (C::*method)(P...)) {
    store<C>(method);
  }
  template <typename C>
  explicit Method(R (C::*method)(P...) const) {
    store<C>(method);
  }

  /// The caller guarantees that the core is of the class that declares the method (the contract
  /// is compared when core and state machine, or core and interface, are put together).
  R operator()(CoreBase& core, P... arguments) const {
    return call_(storage_, core, std::forward<P>(arguments)...);
  }

 private:
  using Call = R (*)(const std::byte* storage, CoreBase& core, P... arguments);

  template <typename C, typename M>
  void store(M method) {
    static_assert(sizeof method <= sizeof storage_);
    std::memcpy(storage_, &method, sizeof method);
    call_ = [](const std::byte* storage, CoreBase& core, P... arguments) -> R {
      M stored;
      std::memcpy(&stored, storage, sizeof stored);
      return (static_cast<C&>(core).*stored)(std::forward<P>(arguments)...);
    };
  }

  alignas(void*) std::byte storage_[2 * sizeof(void*)] = {};
  Call call_ = nullptr;
};

}  // namespace mauve
