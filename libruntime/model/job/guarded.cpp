// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/guarded.h>

#include <mauve/detail/job.h>

#include <set>

#include "base/mutex.h"
#include "rt/guardian/guarded_outputs.h"

namespace mauve {
namespace {

struct Declared {
  Mutex mutex;
  std::multiset<const Configurable*> owners MAUVE_GUARDED_BY(mutex);
};

Declared& declared() {
  static auto* const all = new Declared;  // plugins may drop theirs at the very end
  return *all;
}

}  // namespace

Guarded::Guarded(const Configurable& owner, std::string_view name) : owner_(owner), name_(name) {
  const MutexLock lock(declared().mutex);
  declared().owners.insert(&owner_);
}

Guarded::~Guarded() {
  drop();
  rt::GuardedOutputs::of_process().forget_holder(&owner_);
  const MutexLock lock(declared().mutex);
  declared().owners.erase(declared().owners.find(&owner_));
}

bool Guarded::declared_by(const Configurable& owner) {
  const MutexLock lock(declared().mutex);
  return declared().owners.contains(&owner);
}

Status Guarded::hold(int descriptor, const SafeOrder& order) {
  const std::string name = owner_.address() + "." + std::string(name_);
  Status held = rt::GuardedOutputs::of_process().hold({this, &owner_, name}, descriptor, order);
  if (!held) {
    Error error = held.error();
    error.at = name;
    return error;
  }
  return held;
}

bool is_abandoned() { return this_job().running && this_job().has_no_ports(); }

const std::atomic<std::uint32_t>* Guarded::times_due() const {
  return rt::GuardedOutputs::of_process().times_due(this);
}

void Guarded::repeat() { rt::GuardedOutputs::of_process().repeat(this); }

void Guarded::drop() { rt::GuardedOutputs::of_process().drop(this); }

}  // namespace mauve
