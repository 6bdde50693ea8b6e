// SPDX-License-Identifier: LGPL-3.0-or-later
/// Mailbox: the slots through which the coordinator hands updates to a task and takes them back.
/// Each slot holds one update; the side whose compare-and-swap empties it owns the update.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "rt/process/cache.h"

namespace mauve::exec {

struct TaskUpdate;

class Mailbox {
 public:
  Mailbox() = default;
  ~Mailbox();
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  // --- [control] --------------------------------------------------------------------------------
  /// Hands the task its next update, which it takes at a boundary.
  void publish(TaskUpdate& next) { pending_.store(&next, std::memory_order_release); }
  void publish_rollback(TaskUpdate& back) { back_.store(&back, std::memory_order_release); }
  /// The update takes over by itself when the core fails; the task owns it. False: it has one.
  /// In that case the caller keeps this one.
  bool stand_by(TaskUpdate& standby);
  /// The updates that the task does not use any more, the newest first.
  [[nodiscard]] std::vector<std::unique_ptr<TaskUpdate>> reclaim();
  /// How often the task has passed a quiescent point. Once it passes one, it reads no update that
  /// was withdrawn before.
  [[nodiscard]] std::uint64_t quiescent_count() const {
    return quiescent_count_.load(std::memory_order_acquire);
  }

  // --- [control] and the task: the coordinator withdraws the update that it claims ---------------
  /// Empties the slot of the next update; the caller owns the update. False: the other side claimed
  /// it first.
  bool claim(TaskUpdate& next) { return empty(pending_, next); }
  /// The same for the rollback of a probation.
  bool claim_rollback(TaskUpdate& back) { return empty(back_, back); }
  /// The same for the core that stands by.
  bool claim_standby(TaskUpdate& standby) { return empty(standby_, standby); }

  // --- [any] ------------------------------------------------------------------------------------
  /// A thread that sleeps on this word looks into the mailbox when it changes.
  [[nodiscard]] std::atomic<std::uint32_t>& wake_word() { return wake_word_; }
  /// A stop that does without the coordinator (exec/deploy/direct_stop.h): the task parks at its
  /// next boundary with its safe values written, and stays parked when it applies updates.
  void halt() { halted_.store(true, std::memory_order_release); }
  void end_halt() { halted_.store(false, std::memory_order_release); }
  [[nodiscard]] bool halted() const { return halted_.load(std::memory_order_acquire); }
  /// The number of the stop by a user that stands; 0: none. No update starts the task but one that
  /// ends this stop, whatever the way: a change, a rollback, a swap in place.
  void forbid_start(std::uint64_t stop) { stop_.store(stop, std::memory_order_release); }
  [[nodiscard]] std::uint64_t stop() const { return stop_.load(std::memory_order_acquire); }
  [[nodiscard]] bool on_probation() const {
    return back_.load(std::memory_order_relaxed) != nullptr;
  }

  // --- [rt] the thread of the task --------------------------------------------------------------
  [[nodiscard]] TaskUpdate* pending() const { return pending_.load(std::memory_order_acquire); }
  [[nodiscard]] TaskUpdate* back() const { return back_.load(std::memory_order_acquire); }
  [[nodiscard]] TaskUpdate* standby() const { return standby_.load(std::memory_order_acquire); }
  /// Puts the rollback of a new update in place and leaves null there. Returns the one before, or
  /// null. The code that frees a parameter by value would not fit onto the page of the swap code.
  [[nodiscard]] TaskUpdate* exchange_back(std::unique_ptr<TaskUpdate>&& back);
  /// The same for the core that stands by.
  [[nodiscard]] TaskUpdate* exchange_standby(std::unique_ptr<TaskUpdate>&& standby);
  /// The task does not use it any more; reclaim() returns it. Only the task's thread adds.
  void retire(TaskUpdate& unused);
  /// The task passes a quiescent point: it reads no update that was withdrawn before. The
  /// coordinator sees the new number and frees those updates.
  void count_quiescent() {
    quiescent_count_.store(quiescent_count_ + 1, std::memory_order_release);
  }
  /// Requests the cache lines that a swap writes; does not wait.
  void prefetch() const {
    rt::prefetch(&back_, sizeof back_ + sizeof standby_);
    rt::prefetch(&unused_, sizeof unused_);
  }

 private:
  static bool empty(std::atomic<TaskUpdate*>& slot, TaskUpdate& content) {
    TaskUpdate* expected = &content;
    return slot.compare_exchange_strong(expected, nullptr, std::memory_order_acq_rel);
  }

  alignas(rt::kCacheLine) std::atomic<TaskUpdate*> pending_{nullptr};
  std::atomic<bool> halted_{false};  // beside the slot that the thread reads in each boundary
  std::atomic<std::uint64_t> stop_{0};
  alignas(rt::kCacheLine) std::atomic<TaskUpdate*> unused_{nullptr};
  alignas(rt::kCacheLine) std::atomic<std::uint32_t> wake_word_{0};
  alignas(rt::kCacheLine) std::atomic<TaskUpdate*> back_{nullptr};  // while on probation
  std::atomic<TaskUpdate*> standby_{nullptr};  // the fallback core, or a fresh one
  std::atomic<std::uint64_t> quiescent_count_{0};
};

}  // namespace mauve::exec
