// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/service.h>

#include "model/element/elements.h"
#include "model/job/keep_for_abandoned.h"
#include "model/port/connection.h"
#include "rt/time/measured.h"

namespace mauve {

ComponentBase::ComponentBase(std::string name, ComponentType type, CoreType core)
    : name_(std::move(name)), type_(std::move(type)) {
  auto bundle = std::make_shared<Bundle>();
  auto table = std::make_shared<Bindings>();
  made_ = check_contract(name_ + ".core", core, type_.fsm, type_.shell);
  if (made_) made_ = construct_element(name_ + ".shell", type_.shell.make, bundle->shell);
  if (made_) made_ = construct_element(name_ + ".core", core.make, bundle->core);
  if (made_) made_ = construct_element(name_ + ".fsm", type_.fsm.make, bundle->fsm);
  if (made_) {
    bundle->core->bind(*bundle->shell);
    table->resize(bundle->shell->ports().size());
    // Code uses all three elements before configure() reports a wrong name in one of them.
    made_ = check_names(*bundle->shell);
    if (made_) made_ = check_names(*bundle->core);
    if (made_) made_ = check_names(*bundle->fsm);
  }
  bundle->bindings = std::move(table);
  bundle->core_type = std::move(core);
  bundle->fsm_type = type_.fsm;
  const std::size_t states = bundle->fsm == nullptr ? 0 : bundle->fsm->states().size();
  bundle->measured = std::make_shared<rt::Measured>(states);
  bundle_ = std::move(bundle);
}

// A thread of an element that is not cleaned up may use all three.
ComponentBase::~ComponentBase() {
  static_cast<void>(cleanup());
  const auto unclean = [](const auto& element) {
    return element != nullptr && element->mauve_is_unclean();
  };
  if (bundle_ != nullptr &&
      (unclean(bundle_->shell) || unclean(bundle_->core) || unclean(bundle_->fsm))) {
    keep_for_abandoned(bundle_);
  }
}

TaskAttributes& ComponentBase::task() {
  // Before deployment no other thread sees the bundle.
  return std::const_pointer_cast<Bundle>(bundle_)->task;
}

Status ComponentBase::configure() {
  if (configured_) return ok();
  if (!made_) return made_;
  static_cast<void>(rebind(with_initial(shell(), *bundle_->bindings)));
  const std::array<Configurable*, 3> order{&shell(), &core(), &fsm()};
  if (Status done = configure_in_order(order); !done) return done;
  shell().use(bundle_->bindings.get());
  configured_ = true;
  return ok();
}

Status ComponentBase::cleanup() {
  if (!configured_) return ok();
  configured_ = false;
  shell().use(nullptr);
  const std::array<Configurable*, 3> order{&shell(), &core(), &fsm()};
  return cleanup_in_reverse(order);
}

void ComponentBase::abandon() {
  if (configured_) keep_for_abandoned(bundle_);
  configured_ = false;
}

Status ComponentBase::cleanup_core() {
  configured_ = false;
  const std::array<Configurable*, 2> order{&core(), &fsm()};
  return cleanup_in_reverse(order);
}

Status ComponentBase::replace_core(const CoreType& core) {
  if (ComponentBase::core().configured()) {
    return refuse({Errc::wrong_state, "element_configured"}, name_ + ".core", "is configured",
                  "call cleanup_core() first, or let the deployer swap the core");
  }
  if (Status fits = check_contract(name_ + ".core", core, type_.fsm, type_.shell); !fits) {
    return fits;
  }
  auto bundle = std::make_shared<Bundle>(*bundle_);
  if (Status made = make_element(name_ + ".core", core.make, bundle->core); !made) return made;
  bundle->core->bind(*bundle->shell);
  bundle->core_type = core;
  bundle->measured = std::make_shared<rt::Measured>(bundle->fsm->states().size());
  bundle_ = std::move(bundle);
  return ok();
}

Status ComponentBase::rebind(std::shared_ptr<const Bindings> bindings) {
  auto bundle = std::make_shared<Bundle>(*bundle_);
  bundle->bindings = std::move(bindings);
  if (configured_) shell().use(bundle->bindings.get());
  bundle_ = std::move(bundle);
  return ok();
}

Status ComponentBase::connect(std::string_view port, ServiceBase& service,
                              std::shared_ptr<void> keep_alive, Duration max_age) {
  auto table =
      with_connection(shell(), *bundle_->bindings, port, service, std::move(keep_alive), max_age);
  return table ? rebind(*std::move(table)) : table.error();
}

Status ComponentBase::disconnect(std::string_view port) {
  auto table = without_connection(shell(), *bundle_->bindings, port);
  return table ? rebind(*std::move(table)) : table.error();
}

}  // namespace mauve
