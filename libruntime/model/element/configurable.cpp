// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/configurable.h>

#include "model/element/find_named.h"
#include "model/job/guard.h"

#include <mauve/detail/job.h>
#include <mauve/observable.h>
#include <mauve/property.h>

namespace mauve {
namespace {

/// Adds the address of the element to an error of a hook that gave none.
Status located(Status status, const std::string& address) {
  if (!status && status.error().at.empty()) status.error().at = address;
  return status;
}

}  // namespace

Status Configurable::configure() {
  if (Status outside = refuse_in_job(address_, "configure()"); !outside) return outside;
  if (configured()) return ok();
  if (pending_error_) {
    Error error = *std::move(pending_error_);
    pending_error_.reset();
    return error;
  }
  mauve_reset();
  bool opened = false;  // also when the hook returned too late
  Status sound = call_hook(address_, "on_configure", [&] {
    Status hook = on_configure();
    opened = hook.has_value();
    return hook;
  });
  if (sound) sound = mauve_verify();
  if (!sound) {
    if (opened) {
      static_cast<void>(call_hook(address_, "on_cleanup", [this] { return on_cleanup(), ok(); }));
    }
    return located(std::move(sound), address_);
  }
  configured_.store(true, std::memory_order_release);
  return ok();
}

Status Configurable::cleanup() {
  if (Status outside = refuse_in_job(address_, "cleanup()"); !outside) return outside;
  if (!configured()) return ok();
  configured_.store(false, std::memory_order_release);
  Status done = call_hook(address_, "on_cleanup", [this] { return on_cleanup(), ok(); });
  unclean_ = !done;
  return done;
}

void Configurable::adopt(std::string address) {
  address_ = std::move(address);
  if (given_address_) given_address_(address_);
}

PropertyBase* Configurable::find_property(std::string_view name) const {
  return find_named(properties_, name);
}

ObservableBase* Configurable::find_observable(std::string_view name) const {
  return find_named(observables_, name);
}

}  // namespace mauve
