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

std::string over_budget_in_words(std::uint64_t jobs, const std::string& component) {
  if (jobs == 0) return {};
  return "; " + std::to_string(jobs) + (jobs == 1 ? " job of " : " jobs of ") + component +
         " used more processor time than its budget";
}

}  // namespace mauve::exec
