// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/prepare/afterwards.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "model/component/devices.h"
#include "rt/thread/thread.h"

#include <mauve/host/architecture.h>
#include <mauve/host/change.h>
#include <mauve/host/component.h>
#include <mauve/service.h>

namespace mauve::exec {

Result<ServiceBase*> Afterwards::find_service(std::string_view address) const {
  const std::string_view owner = address.substr(0, address.find('.'));
  for (const NewResource& joining : change_.new_resources) {
    if (joining.resource->name() != owner) continue;
    const auto dot = address.find('.');
    const std::string_view name = dot == std::string_view::npos ? "" : address.substr(dot + 1);
    if (ServiceBase* service = joining.resource->find_service(name)) return service;
    return refuse({Errc::unknown_name, "unknown_service"}, std::string(address),
                  "resource " + joining.resource->name() + " has no service of this name");
  }
  if (leaves(owner)) {
    return refuse({Errc::unknown_name, "removed_by_this_change"}, std::string(address),
                  "is removed by this very change");
  }
  return system_.architecture.find_service(address);
}

bool Afterwards::leaves(std::string_view name) const {
  return std::find(change_.remove.begin(), change_.remove.end(), name) != change_.remove.end();
}

/// Asked before the core is configured, which opens the device. check_fit() compares the components
/// that change with each other.
Status Afterwards::may_open(const std::string& component, const Bundle& next) const {
  Devices devices;
  for (const ComponentBase* one : system_.architecture.components()) {
    const bool another_changes =
        one->name() != component &&
        std::any_of(change_.edits.begin(), change_.edits.end(),
                    [&](const Edit& edit) { return edit.member == one->name(); });
    if (another_changes || leaves(one->name())) continue;
    const auto bundle = one->bundle();
    devices.put(one->name(), *bundle->shell, *bundle->core, false);
  }
  devices.put(component, *next.shell, *next.core, true);
  auto errors = devices.errors();
  return errors.empty() ? ok() : Status(std::move(errors.front()));
}

Status Afterwards::may_run_at(int priority) const {
  return system_.realtime ? rt::may_use_fifo(priority) : ok();
}

}  // namespace mauve::exec
