// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/leavable.h"

#include <utility>

#include "base/mutex.h"

namespace mauve {
namespace {

Leavable*& of_this_thread() {
  [[gnu::tls_model("initial-exec")]] static thread_local Leavable* leavable = nullptr;
  return leavable;
}

}  // namespace

bool Leavable::move(Place from, Place to) {
  return place_.compare_exchange_strong(from, to, std::memory_order_acq_rel);
}

bool Leavable::leave() { return move(Place::outside, Place::left); }

std::string Leavable::hook() const {
  const MutexLock lock(mutex_);
  return hook_;
}

Leavable* Leavable::here() { return of_this_thread(); }

void Leavable::begin_here() { of_this_thread() = this; }

Inside::Inside() : here_(Leavable::here()), inside_(true) {
  if (here_ != nullptr) inside_ = here_->move(Leavable::Place::outside, Leavable::Place::inside);
}

Inside::~Inside() {
  if (here_ != nullptr) here_->move(Leavable::Place::inside, Leavable::Place::outside);
}

InHook::InHook(const std::string& at, const char* hook) : here_(Leavable::here()) {
  if (here_ == nullptr) return;
  {
    const MutexLock lock(here_->mutex_);
    before_ = std::exchange(here_->hook_, at.empty() ? hook : at + " " + hook);
  }
  was_inside_ = here_->move(Leavable::Place::inside, Leavable::Place::outside);
}

bool InHook::back() {
  if (here_ == nullptr) return true;
  {
    const MutexLock lock(here_->mutex_);
    here_->hook_ = std::move(before_);
  }
  return was_inside_ ? here_->move(Leavable::Place::outside, Leavable::Place::inside)
                     : !here_->left();
}

bool left_here() {
  const Leavable* const here = Leavable::here();
  return here != nullptr && here->left();
}

}  // namespace mauve
