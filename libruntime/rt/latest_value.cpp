// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/latest_value.h"

#include <bit>
#include <new>

namespace mauve::rt {
namespace {

constexpr std::size_t kLine = 64;

constexpr std::size_t round_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

constexpr std::uint64_t lowest(unsigned bits) { return (1ULL << bits) - 1; }

}  // namespace

/// A slot that nobody holds: of n + 1, n readers hold at most n. The lowest stays in the cache.
void LatestValue::Lane::choose() { next = static_cast<unsigned>(std::countr_zero(owned & ~held)); }

/// `next` was published in place of the slot in `before`. A reader that took that one has given
/// back what it held of this lane.
void LatestValue::Lane::exchange_for(std::uint64_t before, unsigned readers) {
  const Slots back = Slots{1} << index_of(before);
  owned ^= back ^ Slots{1} << next;
  std::uint64_t holders = before >> kReaderShift & lowest(kMaxReaders + 1);
  if (holders == 0) return;
  for (; holders != 0; holders &= holders - 1) {
    held_by[static_cast<std::size_t>(std::countr_zero(holders))] = back;
  }
  held = 0;
  for (unsigned reader = 0; reader < readers; ++reader) held |= held_by[reader];
}

LatestValue::LatestValue(std::size_t size, std::size_t alignment, unsigned readers)
    : size_(size),
      offset_(round_up(sizeof(Header), alignment)),
      stride_(round_up(offset_ + size, kLine)),
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

/// Where the next value goes, behind its header.
void* LatestValue::fill(Lane& lane, Instant stamp) {
  const Header header{lane.sequence += 2, stamp};
  std::memcpy(slot(lane.next), &header, sizeof header);
  return slot(lane.next) + offset_;
}

bool LatestValue::try_write(const void* data, Instant stamp) {
  if (busy_.exchange(true, std::memory_order_acquire)) return false;
  const std::uint32_t count = count_.load(std::memory_order_acquire);
  quick_.choose();
  std::memcpy(fill(quick_, stamp), data, size_);
  std::uint64_t before = guess_;
  for (;;) {
    // Fails for each reader that takes the newest value meanwhile, and for one from end_write().
    const std::uint64_t after = (before >> kCountShift << kCountShift) | quick_.next;
    if (static_cast<std::int32_t>(count_of(before) - count) > 0) break;
    if (word_.compare_exchange_strong(before, after, std::memory_order_acq_rel)) {
      quick_.exchange_for(before, used_.load(std::memory_order_relaxed));
      guess_ = after | (before & lowest(kMaxReaders + 1) << kReaderShift);  // they come again
      break;
    }
  }
  busy_.store(false, std::memory_order_release);
  return true;
}

void* LatestValue::begin_write() {
  careful_.choose();
  return slot(careful_.next) + offset_;
}

void LatestValue::end_write(Instant stamp) {
  fill(careful_, stamp);
  const std::uint32_t count = count_.load(std::memory_order_relaxed) + 1;
  count_.store(count, std::memory_order_release);
  const std::uint64_t after = std::uint64_t{count} << kCountShift | careful_.next;
  const std::uint64_t before = word_.exchange(after, std::memory_order_acq_rel);
  careful_.exchange_for(before, used_.load(std::memory_order_relaxed));
}

}  // namespace mauve::rt
