// SPDX-License-Identifier: LGPL-3.0-or-later
/// The elements after a change, while the change is prepared.
#pragma once

#include <string_view>

#include "exec/system/system.h"

#include <mauve/result.h>

namespace mauve {
class ServiceBase;
struct Bundle;
struct Change;
}  // namespace mauve

namespace mauve::exec {

/// The elements after the change, for everything that is connected by name. [factory]
class Afterwards {
 public:
  Afterwards(System& system, const Change& change) : system_(system), change_(change) {}

  /// A service of a resource that stays or joins.
  [[nodiscard]] Result<ServiceBase*> find_service(std::string_view address) const;
  [[nodiscard]] bool leaves(std::string_view name) const;
  /// Does no component that the change leaves alone open a device of this shell or core?
  [[nodiscard]] Status may_open(const std::string& component, const Bundle& next) const;
  /// May a thread have this priority here?
  [[nodiscard]] Status may_run_at(int priority) const;

 private:
  System& system_;
  const Change& change_;
};

}  // namespace mauve::exec
