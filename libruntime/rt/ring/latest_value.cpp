// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/latest_value.h>

#include <new>

namespace mauve {

LatestValue::LatestValue(std::size_t size, unsigned readers)
    : size_(size),
      // Small ones share lines: a writer and a reader on two CPUs then move fewer lines than
      // values.
      stride_(slot_size() < kApart ? std::bit_ceil(slot_size()) : round_up(slot_size(), kApart)),
      readers_((readers < kMaxReaders ? readers : kMaxReaders) + 1),
      claimed_(std::make_unique<std::atomic<bool>[]>(readers_)) {
  const unsigned slots = 2 * readers_ + 3;
  memory_ = static_cast<std::byte*>(::operator new (stride_* slots, std::align_val_t{kApart}));
  std::memset(memory_, 0, stride_ * slots);  // touched now, not by a real-time thread
  for (std::uint64_t i = 0; i < slots; ++i) std::memcpy(slot(i) + behind(size_), &i, sizeof i);
  std::uint8_t index = 0;
  alone_.next = index++;
  word_ = index++;
  for (unsigned reader = 0; reader < readers_; ++reader) alone_.held_by[reader] = index++;
  locked_.next = index++;
  for (unsigned reader = 0; reader < readers_; ++reader) locked_.held_by[reader] = index++;
  ahead_ = slot(alone_.next);
  leave(word_);
}

LatestValue::~LatestValue() { ::operator delete (memory_, std::align_val_t{kApart}); }

unsigned LatestValue::attach() {
  for (unsigned i = kInTurn + 1; i < readers_; ++i) {
    if (claimed_[i].exchange(true)) continue;
    unsigned used = used_.load();  // only ever grows, also when two threads attach at once
    while (used <= i && !used_.compare_exchange_weak(used, i + 1)) {
    }
    return i;
  }
  return kNoSlot;
}

void LatestValue::detach(unsigned reader) {
  if (reader < readers_) claimed_[reader].store(false);
}

void LatestValue::take_back(Lane& lane, std::uint64_t before) const {
  lane.next = index_of(before);
  if ((before & kReaders) == 0) return;
  // A reader that took this slot has given back the slot of the lane that it held before.
  Slots all = lane.free | Slots{1} << lane.next;
  Slots held = 0;
  const unsigned readers = used_.load(std::memory_order_relaxed);
  for (unsigned reader = 0; reader < readers; ++reader) {
    std::uint8_t& its = lane.held_by[reader];
    all |= Slots{1} << its;
    if (has_claimed(before, reader)) its = index_of(before);
    held |= Slots{1} << its;
  }
  const Slots free = all & ~held;
  lane.next = static_cast<std::uint8_t>(std::countr_zero(free));
  lane.free = free & (free - 1);
}

bool LatestValue::replace(std::uint64_t& word) {
  const std::uint64_t before = word;
  const std::uint64_t after = (before & kCount) | alone_.next;
  if (!word_.compare_exchange_strong(word, after, std::memory_order_acq_rel)) return false;
  take_back(alone_, before);
  ahead_ = slot(alone_.next);
  // The slot of the first reader is free when that reader takes another one, unless others hold it
  // too.
  if (has_claimed(before, kFirstReader)) {
    const bool shared = (before & kReaders & ~kFirst) != 0;
    unusual_.store(shared ? kReaders : kReaders & ~kFirst, std::memory_order_relaxed);
  }
  leave(after | (before & kReaders));  // a reader that claimed this one takes the next
  return true;
}

void* LatestValue::begin_write() { return slot(locked_.next); }

void LatestValue::end_write(Instant stamp) {
  describe(slot(locked_.next), size_, stamp);
  const std::uint64_t word = word_.load(std::memory_order_relaxed);
  const std::uint64_t count = (word & kCount) + (1ULL << kCountShift);
  take_back(locked_, word_.exchange(count | locked_.next, std::memory_order_acq_rel));
}

}  // namespace mauve
