// SPDX-License-Identifier: LGPL-3.0-or-later
/// LatestValue: wait-free exchange of the newest value between one writer at a time and a fixed
/// number of readers, with n + 2 slots (J. Chen, A. Burns, "A three-slot asynchronous
/// reader/writer mechanism for multiprocessor real-time systems", YCS-286, University of York,
/// 1997, extended to n readers).
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <mauve/time.h>

namespace mauve::rt {

class LatestValue {
 public:
  static constexpr unsigned kMaxReaders = 16;
  static constexpr unsigned kNoSlot = ~0U;

  /// What a slot holds besides the value.
  struct Header {
    std::uint64_t sequence = 0;  ///< 1 for the first value
    Instant stamp = 0;           ///< when it was written
  };
  /// A value that does not move until the view is given back.
  struct View {
    const void* data = nullptr;  ///< null: nothing written yet
    Header header;
  };

  /// `size` bytes a value, `alignment` at most 64.
  LatestValue(std::size_t size, std::size_t alignment, unsigned readers);
  ~LatestValue();
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// A private place for one reader, or kNoSlot when all are taken. [control]
  [[nodiscard]] unsigned attach();
  void detach(unsigned reader);

  /// Storage of the next value; holds some older one. One writer at a time. [rt]
  [[nodiscard]] void* begin_write();
  /// Makes it the newest. [rt], bounded by the number of readers.
  void end_write(Instant stamp);
  /// Both, with a copy between.
  void write(const void* data, Instant stamp);

  /// The newest value, held still until release(). Only the owner of `reader`. [rt], wait-free.
  [[nodiscard]] View acquire(unsigned reader);
  void release(unsigned reader);
  /// The newest value while the caller keeps the writer out.
  [[nodiscard]] View newest() const;

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  static constexpr std::uint32_t kIdle = ~0U;
  static constexpr std::uint32_t kPending = kIdle - 1;
  static constexpr std::uint32_t kNothing = kIdle - 2;

  struct alignas(64) Reader {
    std::atomic<std::uint32_t> slot{kIdle};
    std::atomic<bool> taken{false};
  };

  [[nodiscard]] std::byte* slot(std::uint32_t index) const { return memory_ + index * stride_; }
  [[nodiscard]] View view(std::uint32_t index) const;
  [[nodiscard]] bool in_use(std::uint32_t index, unsigned readers) const;

  std::size_t size_;
  std::size_t offset_;  // of the value behind its header
  std::size_t stride_;
  unsigned readers_;
  std::byte* memory_;
  std::unique_ptr<Reader[]> reader_;
  std::atomic<unsigned> used_{0};  // readers that were ever attached: those the writer looks at
  alignas(64) std::atomic<std::uint32_t> latest_{kNothing};
  std::uint32_t next_ = 0;  // writer only
  std::uint64_t sequence_ = 0;
};

}  // namespace mauve::rt
