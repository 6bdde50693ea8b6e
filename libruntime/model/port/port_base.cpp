// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/port_base.h>

#include <atomic>

#include "model/element/find_named.h"
#include "model/port/connection.h"

#include <mauve/host/resource.h>
#include <mauve/job.h>
#include <mauve/service.h>
#include <mauve/shell.h>

namespace mauve {
PortBase::PortBase(Shell& shell, std::string_view name, Signature signature, Need need,
                   Writers writers)
    : version_(shell.version_),
      need_(need),
      writers_(writers),
      index_(shell.ports_.size()),
      shell_(shell),
      name_(name),
      signature_(std::move(signature)) {
  shell.ports_.push_back(this);
  shell.initial_.emplace_back();
}

std::string PortBase::address() const {
  std::string owner = shell_.address();
  if (const auto dot = owner.rfind('.'); dot != std::string::npos) owner.resize(dot);
  return owner.empty() ? std::string(name_) : owner + ".ports." + std::string(name_);
}

Connected::~Connected() {
  if (!examined_ && !done_ && !shell_.pending_error_)
    shell_.pending_error_ = std::move(done_.error());
}

Connected PortBase::connect(ServiceBase& service, Duration max_age) {
  if (shell_.bindings() != nullptr || shell_.configured()) {
    return {shell_, refuse({Errc::wrong_state, "element_configured"}, address(),
                           "its component is deployed or configured",
                           "use the deployer to connect ports of a running component")};
  }
  std::shared_ptr<const Binding>& binding = shell_.initial_[index_];
  Status fits = check_connection(*this, binding.get(), service, max_age);
  if (fits) {
    binding = std::make_shared<const Binding>(service, service.resource().keep_alive(), max_age);
  }
  return {shell_, std::move(fits)};
}

bool PortBase::connected() const {
  const Bindings* table = shell_.bindings();
  return (table != nullptr ? *table : shell_.initial_bindings())[index_] != nullptr;
}

const Binding* PortBase::binding() {
  if (this_job().has_no_ports()) return nullptr;
  const Bindings* table = shell_.bindings();
  const Binding* binding = table != nullptr ? (*table)[index_].get() : nullptr;
  const bool as_before = direct_version_ == version_;
  direct_version_ = 0;  // a job that is aborted here begins anew
  std::atomic_signal_fence(std::memory_order_seq_cst);
  // With the same connections too: the slot of the cursor may have been given back.
  if (!as_before) cursor_.word = Cursor::kNone;
  if (binding != nullptr && binding->id() != seen_) {
    cursor_ = Cursor{binding->slot()};
    seen_ = binding->id();
  }
  max_age_ = binding != nullptr ? binding->max_age() : Duration{0};
  exchange_ = binding != nullptr && !calls_ ? binding->is_direct() : nullptr;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  direct_version_ = exchange_ != nullptr ? version_ : 0;
  return binding;
}

bool PortBase::notify_taps(const void* value) {
  const Binding* const connection = binding();
  return connection == nullptr || connection->notify_taps(value, job_time());
}

}  // namespace mauve
