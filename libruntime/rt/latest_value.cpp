// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/latest_value.h"

#include <new>

namespace mauve::rt {
namespace {

constexpr std::size_t kLine = 128;

constexpr std::size_t round_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

constexpr std::uint64_t lowest(unsigned bits) { return (1ULL << bits) - 1; }

}  // namespace

/// A reader that took this slot has given back what it held of the lane before.
void LatestValue::Lane::hold(Slots slot, std::uint64_t holders, unsigned readers) {
  for (; holders != 0; holders &= holders - 1) {
    held_by[static_cast<std::size_t>(std::countr_zero(holders))] = slot;
  }
  held = 0;
  for (unsigned reader = 0; reader < readers; ++reader) held |= held_by[reader];
}

LatestValue::LatestValue(std::size_t size, unsigned readers)
    : size_(size),
      behind_(round_up(size, alignof(Header))),
      stride_(round_up(behind_ + sizeof(Header), kLine)),
      readers_((readers < kMaxReaders ? readers : kMaxReaders) + 1),
      slots_(2 * (readers_ + 1) + 1),
      memory_(static_cast<std::byte*>(::operator new (stride_* slots_, std::align_val_t{kLine}))),
      taken_(std::make_unique<std::atomic<bool>[]>(readers_)),
      word_(slots_ - 1) {
  std::memset(memory_, 0, stride_ * slots_);  // touched now, not by a real-time thread
  quick_.owned = lowest(readers_ + 1);
  careful_.owned = quick_.owned << (readers_ + 1);
  careful_.sequence = 1;
}

LatestValue::~LatestValue() { ::operator delete (memory_, std::align_val_t{kLine}); }

unsigned LatestValue::attach() {
  for (unsigned i = kInTurn + 1; i < readers_; ++i) {
    if (taken_[i].exchange(true)) continue;
    unsigned used = used_.load();  // only ever grows, also when two threads attach at once
    while (used <= i && !used_.compare_exchange_weak(used, i + 1)) {
    }
    return i;
  }
  return kNoSlot;
}

void LatestValue::detach(unsigned reader) {
  if (reader < readers_) taken_[reader].store(false);
}

void* LatestValue::begin_write() {
  careful_.choose();
  return slot(careful_.next);
}

void LatestValue::end_write(Instant stamp) {
  describe(careful_, stamp);
  const std::uint32_t count = count_.load(std::memory_order_relaxed) + 1;
  count_.store(count, std::memory_order_release);
  const std::uint64_t after = std::uint64_t{count} << kCountShift | careful_.next;
  const std::uint64_t before = word_.exchange(after, std::memory_order_acq_rel);
  careful_.exchange_for(before, used_.load(std::memory_order_relaxed));
}

}  // namespace mauve::rt
