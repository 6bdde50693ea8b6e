// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/tap.h>

#include <cstring>

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

bool TapList::attach(Tap& tap, Gate& gate) {
  Entry entry(gate);
  if (!entry) return false;
  for (Tap*& place : taps_) {
    if (place != nullptr) continue;
    place = &tap;
    count_.fetch_add(1, std::memory_order_relaxed);
    return true;
  }
  return false;
}

void TapList::detach(Tap& tap, Gate& gate) {
  for (;;) {  // a writer holds the gate for one copy only
    Entry entry(gate);
    if (!entry) continue;
    for (Tap*& place : taps_) {
      if (place != &tap) continue;
      place = nullptr;
      count_.fetch_sub(1, std::memory_order_relaxed);
    }
    return;
  }
}

}  // namespace mauve
