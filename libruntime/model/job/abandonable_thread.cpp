// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/job/abandonable_thread.h"

#include <utility>

#include "base/mutex.h"

namespace mauve {
namespace {

AbandonableThread*& of_this_thread() {
  [[gnu::tls_model("initial-exec")]] static thread_local AbandonableThread* thread = nullptr;
  return thread;
}

}  // namespace

bool AbandonableThread::move(Place from, Place to) {
  return place_.compare_exchange_strong(from, to, std::memory_order_acq_rel);
}

bool AbandonableThread::abandon() { return move(Place::outside, Place::abandoned); }

std::string AbandonableThread::hook() const {
  const MutexLock lock(mutex_);
  return hook_;
}

AbandonableThread* AbandonableThread::here() { return of_this_thread(); }

void AbandonableThread::begin_here() { of_this_thread() = this; }

Inside::Inside() : here_(AbandonableThread::here()), inside_(true) {
  if (here_ != nullptr)
    inside_ = here_->move(AbandonableThread::Place::outside, AbandonableThread::Place::inside);
}

Inside::~Inside() {
  if (here_ != nullptr)
    here_->move(AbandonableThread::Place::inside, AbandonableThread::Place::outside);
}

InHook::InHook(const std::string& at, const char* hook) : here_(AbandonableThread::here()) {
  if (here_ == nullptr) return;
  {
    const MutexLock lock(here_->mutex_);
    before_ = std::exchange(here_->hook_, at.empty() ? hook : at + " " + hook);
  }
  was_inside_ = here_->move(AbandonableThread::Place::inside, AbandonableThread::Place::outside);
}

bool InHook::back() {
  if (here_ == nullptr) return true;
  {
    const MutexLock lock(here_->mutex_);
    here_->hook_ = std::move(before_);
  }
  return was_inside_
             ? here_->move(AbandonableThread::Place::outside, AbandonableThread::Place::inside)
             : !here_->abandoned();
}

bool abandoned_here() {
  const AbandonableThread* const here = AbandonableThread::here();
  return here != nullptr && here->abandoned();
}

}  // namespace mauve
