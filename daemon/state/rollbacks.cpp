// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/rollbacks.h"

#include <algorithm>
#include <utility>

namespace mauve::daemon {

namespace {

/// The newest rollback whose list has the entry.
template <typename Entry>
const RollbackRecord* newest_with(const std::deque<RollbackRecord>& all,
                                  std::vector<Entry> RollbackRecord::*list, const auto& entry) {
  const auto found = std::find_if(all.rbegin(), all.rend(), [&](const RollbackRecord& one) {
    return std::ranges::find(one.*list, entry) != (one.*list).end();
  });
  return found == all.rend() ? nullptr : &*found;
}

}  // namespace

void Rollbacks::ask(std::uint64_t generation, UndoRequest request) {
  requests_.try_emplace(generation, std::move(request));
}

std::optional<UndoRequest> Rollbacks::take(const std::vector<std::uint64_t>& undone) {
  std::optional<UndoRequest> request;
  for (const auto generation : undone) {
    if (auto taken = requests_.extract(generation)) {
      request = std::move(taken.mapped());
    }
  }
  return request;
}

void Rollbacks::remember(RollbackRecord rollback) {
  rollbacks_.push_back(std::move(rollback));
  if (rollbacks_.size() > kMost) {
    rollbacks_.pop_front();
  }
}

const RollbackRecord* Rollbacks::of(std::uint64_t generation) const {
  return newest_with(rollbacks_, &RollbackRecord::undone, generation);
}

const RollbackRecord* Rollbacks::last_of(std::string_view element) const {
  return newest_with(rollbacks_, &RollbackRecord::elements, element);
}

}  // namespace mauve::daemon
