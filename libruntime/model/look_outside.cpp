// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/look_outside.h"

#include "model/guard.h"
#include "rt/deadline.h"

#include <mauve/gate.h>
#include <mauve/resource.h>

namespace mauve {

Result<DataStatus> look_outside(ServiceBase& service, Visitor visitor, Cursor& cursor) {
  if (service.taps() != nullptr) return service.look(visitor, cursor);  // stored: no code of others
  DataStatus status = DataStatus::no_data;
  const std::size_t held = Gate::held();
  const rt::Deadline deadline(kLookMayTake);
  const auto body = [&] {
    status = service.look(visitor, cursor);
    return ok();
  };
  Status done = call_hook(service.address(), "the code of this service", body, deadline.watched());
  if (Gate::held() > held) {
    Gate::poison_and_leave_all(held);
    done.error().message += "; " + service.resource().name() +
                            " is poisoned: it refuses its users until it has a new core";
    done.error().hint = "mend it and reload its plugin, or apply a file that gives it another core";
  }
  if (!done) return done.error();
  return status;
}

}  // namespace mauve
