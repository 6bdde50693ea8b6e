// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/change.h>

#include "exec/prepared.h"
#include "model/elements.h"

namespace mauve {

std::string_view to_string(ChangeState state) {
  switch (state) {
    case ChangeState::unchanged:
      return "unchanged";
    case ChangeState::applied:
      return "applied";
    case ChangeState::rolled_back:
      return "rolled_back";
    case ChangeState::safe:
      return "safe";
  }
  return "unknown";
}

std::string_view to_string(Outcome::Kind kind) {
  switch (kind) {
    case Outcome::Kind::passed:
      return "passed";
    case Outcome::Kind::overtaken:
      return "overtaken";
    case Outcome::Kind::rolled_back:
      return "rolled_back";
    case Outcome::Kind::fell_back:
      return "fell_back";
    case Outcome::Kind::restarted:
      return "restarted";
    case Outcome::Kind::gave_up:
      return "gave_up";
  }
  return "unknown";
}

PreparedChange::PreparedChange(std::unique_ptr<Content> content, Retired elements)
    : elements_(std::move(elements)), content_(std::move(content)) {}
PreparedChange::PreparedChange(PreparedChange&&) noexcept = default;
PreparedChange::~PreparedChange() = default;

Status Retired::release() {
  Status first = ok();
  while (!elements_.empty()) {
    Status done = elements_.back()->cleanup();
    if (first && !done) first = std::move(done);
    const std::string address = elements_.back()->address();
    static_cast<void>(drop_elements(address, [this] { elements_.pop_back(); }));
  }
  while (!owners_.empty()) owners_.pop_back();
  return first;
}

void Retired::keep(std::shared_ptr<void> owner) {
  if (owner != nullptr) owners_.push_back(std::move(owner));
}

void Retired::keep_longest(std::shared_ptr<void> owner) {
  owners_.insert(owners_.begin(), std::move(owner));
}

void Retired::merge(Retired&& other) {
  elements_.insert(elements_.end(), other.elements_.begin(), other.elements_.end());
  owners_.insert(owners_.end(), other.owners_.begin(), other.owners_.end());
  other.forget();
}

}  // namespace mauve
