// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/levels.h"

#include <utility>

#include "base/mutex.h"

namespace mauve::logging {

void Levels::set(const std::string& component, std::optional<Level> level,
                 std::optional<Time> until) {
  const MutexLock lock(mutex_);
  auto& entry = entries_[component];
  entry.passing.reset();
  if (level && until) {
    entry.passing = Setting{component, *level, until};
  } else {
    entry.lasting = level;
  }
  if (!entry.level()) {
    entries_.erase(component);
  }
}

Level Levels::of(const std::string& component) const {
  const MutexLock lock(mutex_);
  return of_locked(component);
}

Level Levels::of_locked(const std::string& component) const {
  if (const auto own = entries_.find(component); own != entries_.end()) {
    return *own->second.level();
  }
  const auto all = entries_.find("");
  return all == entries_.end() ? usual_ : *all->second.level();
}

std::vector<Levels::Setting> Levels::list() const {
  const MutexLock lock(mutex_);
  std::vector<Setting> all;
  for (const auto& [component, entry] : entries_) {
    all.push_back(entry.passing ? *entry.passing : Setting{component, *entry.lasting, {}});
  }
  return all;
}

std::vector<Levels::Setting> Levels::expire(Time now) {
  const MutexLock lock(mutex_);
  std::vector<Setting> over;
  for (auto one = entries_.begin(); one != entries_.end();) {
    const auto here = one++;
    auto& entry = here->second;
    if (!entry.passing || *entry.passing->until > now) {
      continue;
    }
    entry.passing.reset();
    const auto component = here->first;
    if (!entry.lasting) {
      entries_.erase(here);
    }
    over.push_back({component, of_locked(component), {}});
  }
  return over;
}

}  // namespace mauve::logging
