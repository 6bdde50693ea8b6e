// SPDX-License-Identifier: LGPL-3.0-or-later
/// LatestValue: wait-free exchange of the newest value between two writers at a time and a fixed
/// number of readers. Runtime only; ports use it without a call.
///
/// One word says which slot is the newest, and which readers have taken it. A reader that finds
/// itself there still holds that slot; else it adds itself, and so gives back the one before. Who
/// publishes replaces the word, owns the slot that was the newest, and knows who holds it. With one
/// reader this is the triple buffer, at its cost: nothing moves between CPUs but the word and the
/// value.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

#include <mauve/data_status.h>
#include <mauve/time.h>

namespace mauve {

class LatestValue {
 public:
  static constexpr unsigned kMaxReaders = 16;
  static constexpr unsigned kNoSlot = ~0U;
  /// For readers without a place of their own, which take turns.
  static constexpr unsigned kInTurn = 0;

  /// What a slot holds besides the value.
  struct Header {
    std::uint64_t sequence = 0;  ///< of no other value; 0: no value
    Instant stamp = 0;           ///< when it was written
  };
  /// A value that does not move until the same reader asks again.
  struct View {
    const void* data = nullptr;  ///< null: nothing written yet
    Header header;
  };

  /// `size` bytes a value, aligned like any type of that size.
  LatestValue(std::size_t size, unsigned readers);
  ~LatestValue();
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// A private place for one reader, or kNoSlot when all are taken. [control]
  [[nodiscard]] unsigned attach();
  void detach(unsigned reader);

  /// The one writer that needs no lock, by a number that is not 0: the first that comes. True: it
  /// has the place, now or since long. [any]
  bool take_place(std::uint64_t writer) {
    std::uint64_t present = writer_.load(std::memory_order_acquire);
    if (present == 0 && writer_.compare_exchange_strong(present, writer)) return true;
    return present == writer;
  }
  void leave_place(std::uint64_t writer) { writer_.compare_exchange_strong(writer, 0); }

  /// Only in the writer's place, by one thread. False when one was thrown out or lost in here and
  /// did not come back, or `may` says no, which is asked when it is known what overtakes it: then
  /// begin_write(). A value that one from there overtakes is never seen. `size`: known when this is
  /// compiled, or size(). [rt], wait-free.
  template <typename May>
  [[nodiscard, gnu::always_inline]] bool write_alone(const void* data, std::size_t size,
                                                     Instant stamp, const May& may) {
    const std::uint64_t before = sequence_.load(std::memory_order_acquire);
    if ((before & kInside) != 0) return false;
    sequence_.store(before | kInside, std::memory_order_relaxed);
    const std::uint32_t count = count_.load(std::memory_order_acquire);
    // Who takes this place from a lost thread makes all processors pass a barrier in between.
    std::atomic_signal_fence(std::memory_order_seq_cst);
    if (!may()) return false;
    const std::uint64_t sequence = before + kNextAlone;
    std::byte* const at = slot(alone_.next);
    std::memcpy(at, data, size);
    describe(at, {sequence, stamp});
    publish_alone(count);
    sequence_.store(sequence, std::memory_order_release);
    return true;
  }
  /// Storage of the next value; holds some older one. One writer at a time: who calls keeps others
  /// out until end_write(). [rt]
  [[nodiscard]] void* begin_write();
  /// Makes it the newest. [rt], wait-free.
  void end_write(Instant stamp);

  /// The newest value, held still until the next call. Only the owner of `reader`. [rt], wait-free.
  [[nodiscard]] View acquire(unsigned reader) {
    const std::uint64_t me = bit_of(reader);
    std::uint64_t word = word_.load(std::memory_order_acquire);
    if ((word & me) == 0) word = word_.fetch_add(me, std::memory_order_acq_rel);
    return view(index_of(word));
  }
  /// Moves the cursor of a reader with a place of its own to the newest value. [rt], wait-free.
  DataStatus seek(Cursor& cursor) {
    const std::uint64_t word = word_.load(std::memory_order_acquire);
    const bool taken = ((word >> (kReaderShift + cursor.slot)) & 1U) != 0;
    if (taken && cursor.data != nullptr) [[likely]]
      return DataStatus::old_data;
    cursor.data = nullptr;  // who is thrown out of here does not go on with an older one
    std::atomic_signal_fence(std::memory_order_seq_cst);
    return show(acquire(cursor.slot), cursor);
  }
  /// Moves a cursor to what is there to see.
  static DataStatus show(const View& view, Cursor& cursor) {
    if (view.data == nullptr) return DataStatus::no_data;
    const bool fresh = view.header.sequence != cursor.seen;
    cursor.seen = view.header.sequence;
    cursor.stamp = view.header.stamp;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // who is thrown out before begins anew
    cursor.data = view.data;
    return fresh ? DataStatus::new_data : DataStatus::old_data;
  }
  /// The newest value while nobody writes.
  [[nodiscard]] View newest() const { return view(index_of(word_.load())); }

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The slots that a writer alone uses while there is one reader, with what describes them.
  [[nodiscard]] std::array<const std::byte*, 3> first_slots() const {
    return {slot(0), slot(1), slot(2)};
  }
  [[nodiscard]] std::size_t slot_size() const { return behind_ + sizeof(Header); }

 private:
  using Slots = std::uint64_t;  // a bit for each
  /// Two lines of the cache: they are fetched in pairs.
  static constexpr std::size_t kApart = 128;

  // Sequences: of write_alone() multiples of 4, with kInside while it goes on; of others odd.
  static constexpr std::uint64_t kInside = 2;
  static constexpr std::uint64_t kNextAlone = 4;
  static constexpr std::uint64_t kNextCareful = 2;

  // The word: the newest slot, a bit for each reader, and how often end_write() was called.
  static constexpr std::uint8_t kNone = 63;
  static constexpr unsigned kReaderShift = 8;
  static constexpr unsigned kCountShift = 32;
  static constexpr std::uint64_t kReaders = ((1ULL << (kMaxReaders + 1)) - 1) << kReaderShift;
  static unsigned index_of(std::uint64_t word) { return word & 0xFFU; }
  static std::uint64_t bit_of(unsigned reader) { return 1ULL << (kReaderShift + reader); }
  static std::uint32_t count_of(std::uint64_t word) {
    return static_cast<std::uint32_t>(word >> kCountShift);
  }

  /// What a writer owns: the slot for its next value, and for each reader, which holds at most one
  /// of them, another one. All of it in one line of the cache.
  struct Lane {
    Slots others = 0;
    Slots held = 0;
    std::uint8_t next = 0;
    std::array<std::uint8_t, kMaxReaders + 1> held_by{};  // kNone: nothing

    Lane() { held_by.fill(kNone); }
    /// `next` was published in place of the slot in `before`.
    [[gnu::always_inline]] void exchange_for(std::uint64_t before, unsigned readers) {
      const auto back = static_cast<std::uint8_t>(index_of(before));
      const std::uint64_t holders = before & kReaders;
      next = back;
      if (holders == 0) return;
      hold(back, holders >> kReaderShift, readers);
      others |= Slots{1} << back;
      next = static_cast<std::uint8_t>(std::countr_zero(others & ~held));
      others ^= Slots{1} << next;
    }
    /// A reader that took this slot has given back what it held of the lane before.
    [[gnu::always_inline]] void hold(std::uint8_t slot, std::uint64_t holders, unsigned readers) {
      for (; holders != 0; holders &= holders - 1) {
        held_by[static_cast<std::size_t>(std::countr_zero(holders))] = slot;
      }
      held = 0;
      for (unsigned reader = 0; reader < readers; ++reader) held |= Slots{1} << held_by[reader];
    }
  };

  [[nodiscard]] std::byte* slot(unsigned index) const { return memory_ + index * stride_; }
  [[nodiscard]] View view(unsigned index) const {
    View view;
    std::memcpy(&view.header, slot(index) + behind_, sizeof view.header);
    if (view.header.sequence != 0) view.data = slot(index);
    return view;
  }
  void describe(std::byte* slot, const Header& header) const {
    std::memcpy(slot + behind_, &header, sizeof header);
  }

  /// Unless more often than `count` somebody came from end_write().
  [[gnu::always_inline]] void publish_alone(std::uint32_t count) {
    std::uint64_t before = guess_;
    // The word is another one when it was guessed wrongly, and for each reader that takes the
    // newest value just now.
    while (static_cast<std::int32_t>(count_of(before) - count) <= 0) {
      const std::uint64_t after = (before >> kCountShift << kCountShift) | alone_.next;
      if (!word_.compare_exchange_strong(before, after, std::memory_order_acq_rel)) continue;
      alone_.exchange_for(before, used_.load(std::memory_order_relaxed));
      guess_ = after | (before & kReaders);  // who took this one takes the next one
      return;
    }
  }

  // Read by all, hardly ever written.
  alignas(kApart) std::size_t size_;
  std::size_t behind_;  // the value, which begins a line, is the header
  std::size_t stride_;
  std::byte* memory_;
  std::atomic<unsigned> used_{1};         // readers that were ever attached
  std::atomic<std::uint32_t> count_{0};   // of end_write(), before it is to be seen in the word
  std::atomic<std::uint64_t> writer_{0};  // who needs no lock
  unsigned readers_;                      // with those in turn
  std::unique_ptr<std::atomic<bool>[]> taken_;
  alignas(kApart) std::atomic<std::uint64_t> word_;
  alignas(kApart) std::atomic<std::uint64_t> sequence_{0};  // of the value in write_alone()
  std::uint64_t guess_ = 0;                                 // what the word will be there
  Lane alone_;
  alignas(kApart) Lane careful_;
  std::uint64_t careful_sequence_ = 1;
};

}  // namespace mauve
