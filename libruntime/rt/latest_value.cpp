// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/latest_value.h>

#include <new>

namespace mauve {
namespace {

constexpr std::size_t round_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

constexpr std::uint64_t lowest(unsigned bits) { return (1ULL << bits) - 1; }

/// Small ones share lines: a writer and a reader on two CPUs then move fewer lines than values.
constexpr std::size_t stride_of(std::size_t slot, std::size_t apart) {
  return slot < apart ? std::bit_ceil(slot) : round_up(slot, apart);
}

}  // namespace

LatestValue::LatestValue(std::size_t size, unsigned readers)
    : size_(size),
      behind_(round_up(size, alignof(Header))),
      stride_(stride_of(behind_ + sizeof(Header), kApart)),
      readers_((readers < kMaxReaders ? readers : kMaxReaders) + 1),
      taken_(std::make_unique<std::atomic<bool>[]>(readers_)) {
  const unsigned own = readers_ + 1;
  const unsigned slots = 2 * own + 1;
  memory_ = static_cast<std::byte*>(::operator new (stride_* slots, std::align_val_t{kApart}));
  std::memset(memory_, 0, stride_ * slots);  // touched now, not by a real-time thread
  alone_.others = lowest(readers_) << 1;
  careful_.next = static_cast<std::uint8_t>(own);
  careful_.others = alone_.others << own;
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

void* LatestValue::begin_write() { return slot(careful_.next); }

void LatestValue::end_write(Instant stamp) {
  describe(slot(careful_.next), {careful_sequence_ += kNextCareful, stamp});
  const std::uint32_t count = count_.load(std::memory_order_relaxed) + 1;
  count_.store(count, std::memory_order_release);
  const std::uint64_t after = std::uint64_t{count} << kCountShift | careful_.next;
  const std::uint64_t before = word_.exchange(after, std::memory_order_acq_rel);
  careful_.exchange_for(before, used_.load(std::memory_order_relaxed));
}

}  // namespace mauve
