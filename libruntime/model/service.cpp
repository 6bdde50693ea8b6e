// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/service.h>

#include <atomic>

#include "model/find_named.h"
#include "rt/pi_mutex.h"

#include <mauve/clock.h>
#include <mauve/interface.h>
#include <mauve/resource.h>

namespace mauve {

struct Gate::Lock {
  rt::PiMutex mutex;
  std::atomic<std::uint64_t> timeouts{0};
};

Gate::Gate() : lock_(std::make_unique<Lock>()) {}
Gate::~Gate() = default;

bool Gate::enter() {
  Job& job = this_job();
  if (job.held_count == Job::kMaxHeld) return false;
  if (!lock_->mutex.try_lock()) {
    const Duration bound = job.lock_bound > Duration{0} ? job.lock_bound : Duration{1s};
    if (!lock_->mutex.lock_until(MonotonicClock().now() + bound.count())) {
      lock_->timeouts.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
  }
  job.held[job.held_count++] = this;
  return true;
}

void Gate::leave() {
  --this_job().held_count;  // locks nest: the innermost is left first
  lock_->mutex.unlock();
}

std::uint64_t Gate::timeouts() const { return lock_->timeouts.load(std::memory_order_relaxed); }

ServiceBase::ServiceBase(InterfaceBase& owner, std::string_view name, Signature signature)
    : owner_(owner), name_(name), signature_(std::move(signature)) {
  owner.services_.push_back(this);
}

ResourceBase& ServiceBase::resource() const { return owner_.resource(); }
CoreBase& ServiceBase::core() const { return owner_.core(); }
Gate& ServiceBase::gate() const { return owner_.resource().gate(); }
std::string ServiceBase::address() const { return resource().name() + "." + std::string(name_); }

ServiceBase* InterfaceBase::find_service(std::string_view name) const {
  return find_named(services_, name);
}

std::string_view to_string(DataStatus status) {
  switch (status) {
    case DataStatus::no_data:
      return "no_data";
    case DataStatus::old_data:
      return "old_data";
    case DataStatus::new_data:
      return "new_data";
    case DataStatus::stale:
      return "stale";
    case DataStatus::timed_out:
      return "timed_out";
  }
  return "unknown";
}

std::string_view to_string(PortKind kind) {
  switch (kind) {
    case PortKind::read:
      return "read";
    case PortKind::write:
      return "write";
    case PortKind::call:
      return "call";
    case PortKind::event:
      return "event";
  }
  return "unknown";
}

std::string to_string(const Signature& signature) {
  return std::string(to_string(signature.kind)) + " " + signature.types;
}

}  // namespace mauve
