// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/history.h"

#include "base/thread_role.h"

#include <algorithm>

#include "base/mutex.h"

namespace mauve::logging {

namespace {

char small(char letter) {
  return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
}

bool has(std::string_view whole, std::string_view part) {
  return std::search(whole.begin(), whole.end(), part.begin(), part.end(),
                     [](char a, char b) { return small(a) == small(b); }) != whole.end();
}

}  // namespace

bool Filter::accepts(const Record& record) const {
  if (record.level < level || (!component.empty() && component != record.component)) {
    return false;
  }
  if (since && record.time < *since) {
    return false;
  }
  return text.empty() || has(record.text, text) || has(record.component, text) ||
         has(to_string(record.event), text);
}

void History::add(const Record& record) {
  MAUVE_ON_THREAD(log);
  Entries kept;
  {
    const MutexLock lock(mutex_);
    records_.push_back(record);
    if (records_.size() > capacity_) {
      records_.pop_front();
    }
    for (const auto& [id, entry] : followers_) {
      kept.push_back(entry);
    }
  }
  for (const auto& entry : kept) {
    if (entry->filter.accepts(record)) {
      entry->follower(record);
    }
  }
}

std::vector<Record> History::tail(std::size_t count, const Filter& filter) const {
  const MutexLock lock(mutex_);
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
  std::stable_sort(out.begin(), out.end(), [](const Record& a, const Record& b) {
    return a.monotonic_ns < b.monotonic_ns;
  });
  return out;
}

History::Losses History::losses(std::chrono::system_clock::time_point since,
                                const std::string& component) const {
  const MutexLock lock(mutex_);
  Losses losses;
  if (!records_.empty() && records_.front().time > since) {
    losses.gone = records_.front().seq - std::min<std::uint64_t>(records_.front().seq, 1);
  }
  for (const auto& record : records_) {
    const bool counts =
        component.empty() || record.component.empty() || record.component == component;
    if (record.event != Event::events_lost || record.time < since || !counts) {
      continue;
    }
    for (const auto& field : record.fields) {
      const auto* count = std::get_if<std::int64_t>(&field.value);
      losses.lost += field.name == "count" && count != nullptr && *count > 0
                         ? static_cast<std::uint64_t>(*count)
                         : 0;
    }
  }
  return losses;
}

History::Following History::follow(std::size_t count, Filter filter, Follower follower) {
  const MutexLock lock(mutex_);
  Following following{next_id_++, tail_locked(count, filter)};
  followers_[following.id] =
      std::make_shared<const Entry>(Entry{std::move(filter), std::move(follower)});
  return following;
}

void History::unfollow(std::uint64_t id) {
  const MutexLock lock(mutex_);
  followers_.erase(id);
}

}  // namespace mauve::logging
