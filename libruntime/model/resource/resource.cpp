// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/resource.h>
#include <mauve/service.h>
#include <mauve/trace.h>

#include <algorithm>
#include <array>

#include "model/element/elements.h"
#include "model/job/keep_for_abandoned.h"
#include "model/port/connection.h"

namespace mauve {

ResourceBase::ResourceBase(std::string name, ResourceType type)
    : name_(std::move(name)), type_(std::move(type)) {
  lock_.name_in_trace(trace_name_id(name_));
  auto table = std::make_shared<Bindings>();
  made_ = construct_element(name_ + ".shell", type_.shell.make, shell_);
  if (made_) made_ = construct_element(name_ + ".core", type_.core.make, core_);
  if (made_) made_ = construct_element(name_ + ".interface", type_.interface, interface_);
  if (made_) {
    core_->bind(*shell_);
    interface_->bind(*this, core_);
    table->resize(shell_->ports().size());
    // Code uses all three elements before configure() reports a wrong name in one of them.
    made_ = check_names(*shell_);
    if (made_) made_ = check_names(*core_);
    if (made_) made_ = check_names(*interface_);
  }
  bindings_ = std::move(table);
}

// A thread of an element that is not cleaned up may use all three.
ResourceBase::~ResourceBase() {
  static_cast<void>(cleanup());
  const std::array<std::shared_ptr<Configurable>, 3> parts{shell_, core_, interface_};
  const bool unclean = std::any_of(parts.begin(), parts.end(), [](const auto& part) {
    return part != nullptr && part->mauve_is_unclean();
  });
  for (const auto& part : parts) {
    if (unclean) keep_for_abandoned(part);
  }
}

Status ResourceBase::configure() {
  if (configured_) return ok();
  if (!made_) return made_;
  bindings_ = with_initial(*shell_, *bindings_);
  const std::array<Configurable*, 3> order{shell_.get(), core_.get(), interface_.get()};
  if (Status done = configure_in_order(order); !done) return done;
  shell_->use(bindings_.get());
  configured_ = true;
  return ok();
}

Status ResourceBase::cleanup() {
  if (!configured_) return ok();
  configured_ = false;
  shell_->use(nullptr);
  const std::array<Configurable*, 3> order{shell_.get(), core_.get(), interface_.get()};
  return cleanup_in_reverse(order);
}

Status ResourceBase::rebind(std::shared_ptr<const Bindings> bindings) {
  // Accessors use the table under the lock: after the exchange no thread sees the old one.
  ScopedLock held(lock_);
  if (!held) return refuse({Errc::timed_out, "resource_busy"}, name_, "is busy");
  if (configured_) shell_->use(bindings.get());
  bindings_.swap(bindings);
  return ok();
}

Status ResourceBase::connect(std::string_view port, ServiceBase& service,
                             std::shared_ptr<void> keep_alive, Duration max_age) {
  auto table = with_connection(*shell_, *bindings_, port, service, std::move(keep_alive), max_age);
  return table ? rebind(*std::move(table)) : table.error();
}

Status ResourceBase::disconnect(std::string_view port) {
  auto table = without_connection(*shell_, *bindings_, port);
  return table ? rebind(*std::move(table)) : table.error();
}

void ResourceBase::switch_to(const std::shared_ptr<CoreBase>& core,
                             const std::shared_ptr<const Bindings>& bindings) {
  if (core != nullptr) {
    interface_->switch_to(core);
    lock_.clear_poison();
  }
  if (bindings != nullptr && configured_) shell_->use(bindings.get());
}

void ResourceBase::install(std::shared_ptr<CoreBase> core,
                           std::shared_ptr<const Bindings> bindings) {
  if (core != nullptr) core_ = std::move(core);
  if (bindings != nullptr) bindings_ = std::move(bindings);
}

}  // namespace mauve
