// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/resource_lock.h>
#include <mauve/detail/tap.h>
#include <mauve/type.h>

#include <cstring>
#include <utility>

namespace mauve {

Tap::Tap(const DataType& data, std::size_t capacity)
    : data_(data),
      capacity_(capacity),
      stride_((sizeof(Instant) + data.size + 15) / 16 * 16),
      memory_(std::make_unique<std::byte[]>(capacity * stride_)) {}

std::byte* Tap::slot(std::uint64_t index) const {
  return memory_.get() + (index % capacity_) * stride_;
}

void Tap::push(const void* value, Instant stamp) {
  if (closed()) return;
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  if (head - tail_.load(std::memory_order_acquire) == capacity_) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  // The value first: it is at the aligned start of the slot.
  std::memcpy(slot(head), value, data_.size);
  std::memcpy(slot(head) + stride_ - sizeof stamp, &stamp, sizeof stamp);
  head_.store(head + 1, std::memory_order_release);
}

bool Tap::pop(const std::function<void(const void* value, Instant stamp)>& visit) {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  if (tail == head_.load(std::memory_order_acquire)) return false;
  Instant stamp = 0;
  std::memcpy(&stamp, slot(tail) + stride_ - sizeof stamp, sizeof stamp);
  visit(slot(tail), stamp);
  tail_.store(tail + 1, std::memory_order_release);
  return true;
}

Status TapList::attach(std::shared_ptr<Tap> tap, ResourceLock& lock) {
  Taps closed;  // freed when the lock has been released: a writer may wait for it
  ScopedLock held(lock);
  if (!held) return refuse({Errc::timed_out, "resource_busy"}, "", "its resource is busy");
  release_closed(closed);
  for (std::shared_ptr<Tap>& slot : taps_) {
    if (slot != nullptr) continue;
    slot = std::move(tap);
    count_.fetch_add(1);  // from now on no writer passes by the lock
    return ok();
  }
  return refuse({Errc::limit, "watched_by_too_many"}, "", "is watched by too many clients already");
}

void TapList::detach(Tap& tap, ResourceLock& lock) {
  tap.close();
  Taps closed;
  ScopedLock held(lock);
  if (held) release_closed(closed);
}

void TapList::release_closed(Taps& into) {
  for (std::size_t i = 0; i < kMaxTaps; ++i) {
    if (taps_[i] == nullptr || !taps_[i]->closed()) continue;
    into[i] = std::exchange(taps_[i], nullptr);
    count_.fetch_sub(1, std::memory_order_relaxed);
  }
}

}  // namespace mauve
