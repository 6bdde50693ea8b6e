// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/retired.h>

#include <memory>
#include <string>
#include <utility>

#include "model/element/elements.h"
#include "model/job/keep_for_abandoned.h"

namespace mauve {

Status Retired::release() {
  Status first = ok();
  while (!elements_.empty()) {
    Status done = elements_.back()->cleanup();
    if (elements_.back()->mauve_is_unclean()) {
      if (first && !done) first = std::move(done);
      break;
    }
    const std::string address = elements_.back()->address();
    static_cast<void>(drop_elements(address, [this] { elements_.pop_back(); }));
  }
  // A thread of an element that is not cleaned up may use those that it refers to.
  for (auto& element : elements_) keep_for_abandoned(std::move(element));
  const bool unclean = !elements_.empty();
  elements_.clear();
  for (auto& owner : owners_) {
    if (unclean) keep_for_abandoned(owner);
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
