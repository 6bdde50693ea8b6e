// SPDX-License-Identifier: LGPL-3.0-or-later
/// Shell: the outside of a component or resource: ports and properties (paper 3.3.2).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <mauve/detail/binding.h>
#include <mauve/detail/configurable.h>

namespace mauve {

class PortBase;

/// Base of the outside of a component or resource. Derive, and declare ports and properties as
/// members. The runtime owns the object, and it stays when the core is replaced.
/// @snippet api_examples.cpp Shell
class Shell : public Configurable {
 public:
  /// In the order of declaration.
  [[nodiscard]] const std::vector<PortBase*>& ports() const { return ports_; }
  [[nodiscard]] PortBase* find_port(std::string_view name) const;  ///< null: there is none

  /// Runtime only. The connections in force; exchanged by the component's own thread.
  [[nodiscard]] const Bindings* bindings() const { return bindings_; }
  /// Runtime only: these connections from now on. [rt] of the component.
  void use(const Bindings* bindings) {
    ++version_;  // also for the same ones: others may have used them meanwhile
    bindings_ = bindings;
  }

  /// Runtime only. Connections made in code with PortBase::connect, moved out once by the owner.
  [[nodiscard]] Bindings& initial_bindings() { return initial_; }

 private:
  friend class PortBase;

  std::vector<PortBase*> ports_;
  Bindings initial_;
  const Bindings* bindings_ = nullptr;
  std::uint64_t version_ = 1;  // of bindings_: no port has seen it yet
};

}  // namespace mauve
