// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/history.h"

#include <algorithm>

namespace mauve::logging {

bool Filter::accepts(const Record& record) const {
  return record.level >= level && (component.empty() || component == record.component);
}

void History::add(const Record& record) {
  const std::lock_guard lock(mutex_);
  records_.push_back(record);
  if (records_.size() > capacity_) {
    records_.pop_front();
  }
  for (const auto& [id, entry] : followers_) {
    if (entry.filter.accepts(record)) {
      entry.follower(record);
    }
  }
}

std::vector<Record> History::tail(std::size_t count, const Filter& filter) const {
  const std::lock_guard lock(mutex_);
  return tail_locked(count, filter);
}

std::vector<Record> History::tail_locked(std::size_t count, const Filter& filter) const {
  std::vector<Record> out;
  for (auto it = records_.rbegin(); it != records_.rend() && out.size() < count; ++it) {
    if (filter.accepts(*it)) {
      out.push_back(*it);
    }
  }
  std::reverse(out.begin(), out.end());
  return out;
}

History::Following History::follow(std::size_t count, Filter filter, Follower follower) {
  const std::lock_guard lock(mutex_);
  Following following{next_id_++, tail_locked(count, filter)};
  followers_[following.id] = {std::move(filter), std::move(follower)};
  return following;
}

void History::unfollow(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  followers_.erase(id);
}

}  // namespace mauve::logging
