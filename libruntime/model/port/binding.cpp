// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/binding.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include <mauve/detail/exchange.h>
#include <mauve/detail/job.h>
#include <mauve/detail/resource_lock.h>
#include <mauve/host/resource.h>
#include <mauve/job.h>
#include <mauve/service.h>

namespace mauve {
namespace {

std::uint64_t next_binding_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

Binding::Binding(ServiceBase& service, std::shared_ptr<void> keep_alive, Duration max_age)
    : keep_alive_(std::move(keep_alive)),
      service_(service),
      id_(next_binding_id()),
      slot_(service.attach()),
      max_age_(max_age),
      exchange_(service.exchange()) {
  static_cast<void>(is_direct());
}

Binding::~Binding() {
  service_.detach(slot_);
  if (exchange_ != nullptr) exchange_->latest.release_slot(id_);
}

Exchange* Binding::is_direct() const {
  if (exchange_ == nullptr) return nullptr;
  const bool writes = service_.signature().kind == PortKind::write;
  const bool own = writes ? exchange_->latest.claim_slot(id_) : slot_ != LatestValue::kNoSlot;
  return own ? exchange_ : nullptr;
}

bool Binding::write(const void* value) const {
  const Instant stamp = job_time();
  Exchange* const exchange = is_direct();
  // Also while taps are attached: the value is out before this thread waits for the lock.
  if (exchange != nullptr && exchange->write_alone(value, exchange->latest.size(), stamp)) {
    return notify_taps(value, stamp);
  }
  return !this_job().has_no_ports() && service_.write(value);
}

bool Binding::notify_taps(const void* value, Instant stamp) const {
  if (exchange_->taps.empty()) return true;
  const ScopedLock held(service_.resource().lock());
  if (held) exchange_->taps.push(value, stamp);
  return true;
}

}  // namespace mauve
