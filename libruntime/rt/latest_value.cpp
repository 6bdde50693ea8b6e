// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/latest_value.h"

#include <cstring>
#include <new>

namespace mauve::rt {
namespace {

constexpr std::size_t kLine = 64;

constexpr std::size_t round_up(std::size_t value, std::size_t step) {
  return (value + step - 1) / step * step;
}

}  // namespace

LatestValue::LatestValue(std::size_t size, std::size_t alignment, unsigned readers)
    : size_(size),
      offset_(round_up(sizeof(Header), alignment)),
      stride_(round_up(offset_ + size, kLine)),
      readers_(readers < kMaxReaders ? readers : kMaxReaders),
      memory_(static_cast<std::byte*>(
          ::operator new (stride_*(readers_ + 2), std::align_val_t{kLine}))),
      reader_(std::make_unique<Reader[]>(readers_)) {
  std::memset(memory_, 0, stride_ * (readers_ + 2));  // touched now, not by a real-time thread
}

LatestValue::~LatestValue() { ::operator delete (memory_, std::align_val_t{kLine}); }

unsigned LatestValue::attach() {
  for (unsigned i = 0; i < readers_; ++i) {
    if (reader_[i].taken.exchange(true)) continue;
    unsigned used = used_.load();  // only ever grows, also when two threads attach at once
    while (used <= i && !used_.compare_exchange_weak(used, i + 1)) {
    }
    return i;
  }
  return kNoSlot;
}

void LatestValue::detach(unsigned reader) {
  if (reader < readers_) reader_[reader].taken.store(false);
}

bool LatestValue::in_use(std::uint32_t index, unsigned readers) const {
  for (unsigned i = 0; i < readers; ++i) {
    if (reader_[i].slot.load() == index) return true;
  }
  return false;
}

void* LatestValue::begin_write() {
  // Of n + 2 slots, n readers hold at most n and one is the latest: one is always free.
  const std::uint32_t latest = latest_.load(std::memory_order_relaxed);
  const unsigned readers = used_.load();
  std::uint32_t index = 0;
  while (index == latest || in_use(index, readers)) ++index;
  next_ = index;
  return slot(index) + offset_;
}

void LatestValue::end_write(Instant stamp) {
  const Header header{++sequence_, stamp};
  std::memcpy(slot(next_), &header, sizeof header);
  latest_.store(next_);
  // A reader that announced itself but has not chosen yet is given this slot: it can then not
  // choose one that the next write would take. All operations here are sequentially consistent.
  const unsigned readers = used_.load();
  for (unsigned i = 0; i < readers; ++i) {
    std::uint32_t expected = kPending;
    if (reader_[i].slot.load() == kPending) {
      reader_[i].slot.compare_exchange_strong(expected, next_);
    }
  }
}

void LatestValue::write(const void* data, Instant stamp) {
  std::memcpy(begin_write(), data, size_);
  end_write(stamp);
}

LatestValue::View LatestValue::view(std::uint32_t index) const {
  View view{slot(index) + offset_, {}};
  std::memcpy(&view.header, slot(index), sizeof view.header);
  return view;
}

LatestValue::View LatestValue::acquire(unsigned reader) {
  std::atomic<std::uint32_t>& mine = reader_[reader].slot;
  mine.store(kPending);
  std::uint32_t index = latest_.load();
  if (index == kNothing) {
    mine.store(kIdle, std::memory_order_release);
    return {};
  }
  std::uint32_t expected = kPending;
  if (!mine.compare_exchange_strong(expected, index)) index = expected;
  return view(index);
}

void LatestValue::release(unsigned reader) {
  reader_[reader].slot.store(kIdle, std::memory_order_release);
}

LatestValue::View LatestValue::newest() const {
  const std::uint32_t index = latest_.load();
  return index == kNothing ? View{} : view(index);
}

}  // namespace mauve::rt
