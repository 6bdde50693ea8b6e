// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/latest_value.h"

#include <new>

namespace mauve::rt {
namespace {

constexpr std::size_t round_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

constexpr std::uint64_t lowest(unsigned bits) { return (1ULL << bits) - 1; }

}  // namespace

LatestValue::LatestValue(std::size_t size, unsigned readers)
    : size_(size),
      behind_(round_up(size, alignof(Header))),
      stride_(round_up(behind_ + sizeof(Header), kApart)),
      readers_((readers < kMaxReaders ? readers : kMaxReaders) + 1),
      taken_(std::make_unique<std::atomic<bool>[]>(readers_)) {
  const unsigned own = readers_ + 1;
  const unsigned slots = 2 * own + 1;
  memory_ = static_cast<std::byte*>(::operator new (stride_* slots, std::align_val_t{kApart}));
  std::memset(memory_, 0, stride_ * slots);  // touched now, not by a real-time thread
  quick_.owned = lowest(own);
  careful_.owned = lowest(own) << own;
  careful_.sequence = 1;
  word_ = slots - 1;
}

LatestValue::~LatestValue() { ::operator delete (memory_, std::align_val_t{kApart}); }

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
