// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/retired.h>

#include <memory>
#include <string>
#include <utility>

#include "model/element/elements.h"

namespace mauve {
namespace {

/// Its clean-up did not end: a thread of it may still run, or not be joined, so that its destructor
/// would end the process. It holds its plugin, which stays in memory too.
void keep_for_ever(std::shared_ptr<Configurable> element) {
  static_cast<void>(new std::shared_ptr<Configurable>(std::move(element)));
}

}  // namespace

Status Retired::release() {
  Status first = ok();
  while (!elements_.empty()) {
    Status done = elements_.back()->cleanup();
    if (elements_.back()->mauve_is_unclean()) {
      keep_for_ever(std::move(elements_.back()));
      elements_.pop_back();
      if (first && !done) first = std::move(done);
      continue;
    }
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
