// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/recovery/incident.h"

#include <string>

#include "exec/system/system.h"
#include "exec/update/fault_record.h"

#include <mauve/host/architecture.h>

namespace mauve::exec {

Incident incident_of(const System& system, const FaultRecord& record) {
  Incident incident{record.time,
                    std::string(to_string(record.cause)),
                    record.text.data(),
                    record.core.data(),
                    record.state.data(),
                    record.job,
                    {}};
  for (const ResourceBase* resource : system.architecture.resources()) {
    if (&resource->lock() == record.failed_in_lock) incident.resource = resource->name();
  }
  return incident;
}

}  // namespace mauve::exec
