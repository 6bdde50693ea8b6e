// SPDX-License-Identifier: LGPL-3.0-or-later
/// The CPU of each component whose task names none.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "exec/system/system.h"

#include <mauve/detail/binding.h>

namespace mauve::exec {

/// Resources whose lock a call through these connections may take, by themselves or through their
/// own ports. Those of SharedData are held for some stores and are not among them.
[[nodiscard]] std::set<ResourceBase*> locks_of(const Bindings& bindings);

/// Errors: a CPU that is not there.
[[nodiscard]] Status check_cpus(const TaskAttributes& task, const std::string& component);

/// The CPUs of each task. Admission asks it for the CPUs that deployment will choose.
class Placement {
 public:
  /// Begins with the deployed components; their order counts.
  explicit Placement(const System& system);

  struct Seat {
    std::vector<int> cpus;
    std::string why;  ///< empty: the task names them
  };
  /// The CPUs that the task names. Else the CPU of the components that share a lock with it, also
  /// by way of others, since priority inheritance holds on one CPU only. Else the CPU with the
  /// fewest components so far. The component counts as placed there from now on.
  Seat seat(const std::string& name, const Bundle& bundle);

 private:
  struct Placed {
    std::string name;
    std::set<ResourceBase*> locks;
    std::vector<int> cpus;
  };
  [[nodiscard]] int least_used() const;
  [[nodiscard]] std::set<ResourceBase*> linked_by(std::set<ResourceBase*> locks) const;

  std::vector<Placed> placed_;
  std::vector<std::set<ResourceBase*>> all_;  ///< locks of each, placed or not
};

/// Chooses the CPU of a component that is not deployed yet, or that has none so far.
void place(System& system, Deployed& deployed);

}  // namespace mauve::exec
