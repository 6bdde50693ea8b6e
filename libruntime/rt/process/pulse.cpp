// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/pulse.h"

#include <algorithm>
#include <utility>

#include "base/mutex.h"

namespace mauve::rt {

struct Pulse::All {
  Mutex mutex;
  std::vector<Pulse*> pulses MAUVE_GUARDED_BY(mutex);
};

/// Never destroyed: an abandoned thread may end after main() has returned.
Pulse::All& Pulse::all() {
  static auto* const all = new All;
  return *all;
}

Pulse::Pulse(std::string name) : name_(std::move(name)) {
  auto& list = all();
  const MutexLock lock(list.mutex);
  list.pulses.push_back(this);
}

Pulse::~Pulse() {
  auto& list = all();
  const MutexLock lock(list.mutex);
  std::erase(list.pulses, this);
}

std::vector<Pulse::Silent> Pulse::look(Duration passed) {
  std::vector<Silent> found;
  auto& list = all();
  const MutexLock lock(list.mutex);
  for (auto* pulse : list.pulses) {
    const auto bound = pulse->bound_.load(std::memory_order_acquire);
    const auto turns = pulse->turns_.load(std::memory_order_relaxed);
    const bool turned = std::exchange(pulse->seen_, turns) != turns;
    pulse->silent_ = turned ? Duration{0} : pulse->silent_ + std::min(passed, kMostOfALook);
    if (pulse->silent_.count() > bound) {
      found.push_back({pulse->name_, pulse->silent_});
    }
  }
  return found;
}

}  // namespace mauve::rt
