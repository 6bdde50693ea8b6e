// SPDX-License-Identifier: LGPL-3.0-or-later
/// LatestValue: wait-free exchange of the newest value between two writers at a time and a fixed
/// number of readers. Runtime only; ports use it without a call.
///
/// One word holds the number of the newest slot and a mark for each reader that has claimed it. A
/// reader that finds its mark still holds that slot. Else it adds its mark, and so releases the
/// slot before. A writer that publishes replaces the word, owns the slot that was the newest, and
/// knows the readers that hold it. With one reader this is the triple buffer, at its cost: nothing
/// moves between CPUs but the word and the value.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

#include <mauve/detail/data_status.h>
#include <mauve/time.h>

namespace mauve {

class LatestValue {
 public:
  static constexpr unsigned kMaxReaders = 8;
  static constexpr unsigned kNoSlot = ~0U;
  /// For readers without a slot of their own, which take turns.
  static constexpr unsigned kInTurn = 0;
  static constexpr unsigned kFirstReader = 1;

  /// The data of a slot besides the value.
  struct Header {
    std::uint64_t sequence = 0;  ///< of no other value; below kFirstSequence: no value
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
  /// A private slot for one reader, or kNoSlot when all are claimed. [control]
  [[nodiscard]] unsigned attach();
  void detach(unsigned reader);

  /// Claims the slot of the one writer that needs no lock, by a number that is not 0, for the first
  /// caller. True: the writer owns the slot, also since an earlier call. [any]
  bool claim_slot(std::uint64_t writer) {
    std::uint64_t present = writer_.load(std::memory_order_acquire);
    if (present == 0 && writer_.compare_exchange_strong(present, writer)) return true;
    return present == writer;
  }
  void release_slot(std::uint64_t writer) { writer_.compare_exchange_strong(writer, 0); }

  /// Publishes a value without a lock; only for the thread that owns the writer's slot. False: call
  /// begin_write(). That is after a job was aborted in here, or when may() is false, which is
  /// called once the word to replace is known. A value that begin_write() overtakes is never seen.
  /// `size`: a constant, or size(). [rt], wait-free.
  template <typename May>
  [[nodiscard, gnu::noinline]] bool write_alone(const void* data, std::size_t size, Instant stamp,
                                                const May& may) {
    if (!may()) return false;  // does not even go in
    std::uint64_t word = expected_.load(std::memory_order_acquire);
    if (word == kInside || !enter(may)) return false;
    put(ahead_, data, size, stamp);
    if (replace(word)) return true;
    std::atomic_signal_fence(std::memory_order_seq_cst);
    if (!may()) return false;
    // Now it fails once for each reader that takes the newest value meanwhile.
    for (const std::uint64_t count = word & kCount; (word & kCount) == count;) {
      if (replace(word)) return true;
    }
    leave(word);
    return true;
  }
  /// The fast path of most writes: the word is the expected one, and of the readers only the first
  /// has claimed the newest value. False: nothing is published, call write_alone().
  template <typename May>
  [[nodiscard, gnu::always_inline]] bool write_as_expected(const void* data, std::size_t size,
                                                           Instant stamp, const May& may) {
    const std::uint64_t expected = expected_.load(std::memory_order_acquire);
    const std::uint64_t unusual = unusual_.load(std::memory_order_relaxed);
    if ((expected & unusual) != 0 || !enter(may)) [[unlikely]]  // kInside is all bits
      return false;
    put(ahead_, data, size, stamp);
    return exchange_slots(expected);
  }
  /// Storage of the next value; holds some older one. One writer at a time: the caller keeps others
  /// out until end_write(). [rt]
  [[nodiscard]] void* begin_write();
  /// Makes it the newest. [rt], wait-free.
  void end_write(Instant stamp);

  /// The newest value, held still until the next call. Only the owner of `reader`. [rt], wait-free.
  [[nodiscard]] View acquire(unsigned reader) { return view(index_of(take(reader))); }
  /// Moves the cursor of a reader with a slot of its own to the newest value. [rt], wait-free.
  DataStatus seek(Cursor& cursor) {
    if (word_.load(std::memory_order_acquire) == cursor.word) [[likely]]
      return DataStatus::old_data;
    cursor.word = Cursor::kNone;  // a job that is aborted here does not go on with an older one
    std::atomic_signal_fence(std::memory_order_seq_cst);
    const std::uint64_t word = take(cursor.slot);
    const DataStatus status = show(view(index_of(word)), cursor);
    std::atomic_signal_fence(std::memory_order_seq_cst);
    if (status != DataStatus::no_data) cursor.word = word;
    return status;
  }
  /// Moves a cursor to the value of the view.
  static DataStatus show(const View& view, Cursor& cursor) {
    if (view.data == nullptr) return DataStatus::no_data;
    const bool fresh = view.header.sequence != cursor.seen;
    cursor.seen = view.header.sequence;
    cursor.stamp = view.header.stamp;
    cursor.data = view.data;
    return fresh ? DataStatus::new_data : DataStatus::old_data;
  }
  /// The newest value, while no thread writes.
  [[nodiscard]] View newest() const { return view(index_of(word_.load())); }

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The slots, headers included, that a single writer uses while there is one reader.
  [[nodiscard]] std::array<const std::byte*, 3> first_slots() const {
    return {slot(0), slot(1), slot(2 + kFirstReader)};
  }
  [[nodiscard]] std::size_t slot_size() const { return behind(size_) + sizeof(Header); }

 private:
  using Slots = std::uint64_t;  // a bit for each
  /// Two lines of the cache: they are fetched in pairs.
  static constexpr std::size_t kApart = 128;

  // The word: the newest slot; for each reader two bits, not 0 when it has claimed that slot; and
  // how often end_write() was called. Two bits: an abandoned thread may claim it after its
  // replacement did, and releases the slot before until the replacement claims anew.
  static constexpr unsigned kReaderShift = 6;
  static constexpr unsigned kCountShift = kReaderShift + 2 * (kMaxReaders + 1);
  static constexpr std::uint64_t kFirstSequence = 1U << kReaderShift;  // more than there are slots
  static constexpr std::uint64_t kIndex = kFirstSequence - 1;
  static constexpr std::uint64_t kCount = ~0ULL << kCountShift;
  static constexpr std::uint64_t kReaders = ~(kCount | kIndex);
  static constexpr std::uint64_t kFirst = 3U << (kReaderShift + 2 * kFirstReader);
  static constexpr std::uint64_t kInside = ~0ULL;  // no word: so many slots there are not
  static std::uint8_t index_of(std::uint64_t word) { return word & kIndex; }
  static bool has_claimed(std::uint64_t word, unsigned reader) {
    return (word >> (kReaderShift + 2 * reader) & 3U) != 0;
  }

  /// The slots of a writer: one for its next value, and for each reader another one, which that
  /// reader may hold. Readers that hold the same slot leave some free. All in one cache line.
  struct Lane {
    Slots free = 0;
    std::uint8_t next = 0;
    std::array<std::uint8_t, kMaxReaders + 1> held_by{};
  };
  /// The word in which the reader has claimed the newest slot.
  std::uint64_t take(unsigned reader) {
    const std::uint64_t word = word_.load(std::memory_order_acquire);
    if (has_claimed(word, reader)) return word;
    const std::uint64_t its = 1ULL << (kReaderShift + 2 * reader);
    return word_.fetch_add(its, std::memory_order_acq_rel) + its;
  }
  /// `lane.next` was published in place of the slot in the word `before`.
  void take_back(Lane& lane, std::uint64_t before) const;

  [[nodiscard]] std::byte* slot(std::size_t index) const { return memory_ + index * stride_; }
  [[nodiscard]] View view(unsigned index) const {
    View view;
    std::memcpy(&view.header, slot(index) + behind(size_), sizeof view.header);
    if (view.header.sequence >= kFirstSequence) view.data = slot(index);
    return view;
  }
  /// Where the header is: the value begins a line of the cache.
  static constexpr std::size_t behind(std::size_t size) { return round_up(size, alignof(Header)); }
  static constexpr std::size_t round_up(std::size_t size, std::size_t step) {
    return (size + step - 1) / step * step;
  }
  /// Each slot counts for itself, from its index on.
  static void describe(std::byte* slot, std::size_t size, Instant stamp) {
    Header header;
    std::memcpy(&header.sequence, slot + behind(size), sizeof header.sequence);
    header.sequence += kFirstSequence;
    header.stamp = stamp;
    std::memcpy(slot + behind(size), &header, sizeof header);
  }
  [[gnu::always_inline]] static void put(std::byte* slot, const void* data, std::size_t size,
                                         Instant stamp) {
    describe(slot, size, stamp);
    std::memcpy(slot, data, size);
  }

  template <typename May>
  [[gnu::always_inline]] bool enter(const May& may) {
    expected_.store(kInside, std::memory_order_relaxed);
    // A thread that claims an abandoned one's slot makes all processors pass a barrier in between.
    std::atomic_signal_fence(std::memory_order_seq_cst);
    return may();
  }
  [[gnu::always_inline]] void leave(std::uint64_t expected) {
    expected_.store(expected, std::memory_order_release);
  }
  /// Publishes `alone_.next` and leaves; false, and the new word, when the word has changed.
  bool replace(std::uint64_t& word);
  /// The same when the first reader is the only one: this is the triple buffer.
  [[gnu::always_inline]] bool exchange_slots(std::uint64_t word) {
    std::uint64_t before = 0;
    do {
      before = word;
      const std::uint64_t low = before & (kFirst | kIndex);
      const std::uint64_t after = (before ^ low) | alone_.next;
      const bool claimed = (low & kFirst) != 0;
      const std::uint8_t back = index_of(low);
      std::uint8_t& held = alone_.held_by[kFirstReader];
      const std::uint8_t next = claimed ? held : back;
      if (word_.compare_exchange_strong(word, after, std::memory_order_acq_rel)) [[likely]] {
        if (claimed) held = back;
        alone_.next = next;
        ahead_ = slot(next);
        leave(after | (low & kFirst));  // a reader that took this one takes the next one
        return true;
      }
    } while (((word ^ before) & ~kFirst) == 0 &&
             (word & unusual_.load(std::memory_order_relaxed)) == 0);
    leave(word);
    return false;
  }

  // Read by all, hardly ever written.
  alignas(kApart) std::size_t size_;
  std::size_t stride_;
  std::byte* memory_;
  std::atomic<unsigned> used_{1};         // readers that were ever attached
  std::atomic<std::uint64_t> writer_{0};  // the one that needs no lock
  unsigned readers_;                      // with those in turn
  std::unique_ptr<std::atomic<bool>[]> claimed_;
  alignas(kApart) std::atomic<std::uint64_t> word_;
  alignas(kApart) std::atomic<std::uint64_t> expected_;     // the word to be replaced, or kInside
  std::byte* ahead_;                                        // the slot for its next value
  std::atomic<std::uint64_t> unusual_{kReaders & ~kFirst};  // see replace()
  Lane alone_;
  alignas(kApart) Lane locked_;
};

}  // namespace mauve
