// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/job/look_outside.h"

#include "model/job/guard.h"
#include "rt/thread/deadline.h"

#include <mauve/detail/resource_lock.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve {

namespace {

/// Runs `body`, which calls code of the service, so that a failure ends that call only.
template <typename Body>
Status guarded(ServiceBase& service, const Body& body) {
  const std::size_t held = ResourceLock::held();
  const rt::Deadline deadline(kLookMayTake);
  Status done = call_hook(service.address(), "the code of this service", body, deadline.watched());
  if (ResourceLock::held() > held) {
    ResourceLock::poison_and_leave_all(held);
    done.error().message += "; " + service.resource().name() +
                            " is poisoned: it refuses its users until it has a new core";
    done.error().hint =
        "correct it and reload its plugin, or apply a file that gives it another core";
  }
  return done;
}

}  // namespace

Result<DataStatus> look_outside(ServiceBase& service, Visitor visitor, Cursor& cursor) {
  if (service.taps() != nullptr) return service.look(visitor, cursor);  // stored: no code of others
  DataStatus status = DataStatus::no_data;
  Status done = guarded(service, [&] {
    status = service.look(visitor, cursor);
    return ok();
  });
  if (!done) return done.error();
  return status;
}

Result<bool> use_outside(ServiceBase& service, void* result, void* const* arguments) {
  const bool writes = service.signature().kind == PortKind::write;
  if (writes && service.taps() != nullptr) return service.write(arguments[0]);
  bool accepted = false;
  Status done = guarded(service, [&] {
    accepted = writes ? service.write(arguments[0]) : service.invoke(result, arguments);
    return ok();
  });
  if (!done) return done.error();
  return accepted;
}

}  // namespace mauve
