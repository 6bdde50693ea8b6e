// SPDX-License-Identifier: LGPL-3.0-or-later
/// A thread that runs user code for others. When that code does not return, the thread is
/// abandoned: from then on it may free the objects that it made itself, and nothing else.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "base/mutex.h"

namespace mauve {

/// The place of the thread, seen from the model, which other threads use too:
///   `outside`: in user code, or at objects of its own, so it can be abandoned.
///   `inside`: it uses the model, for a bounded time, so a caller of abandon() tries again.
///   `abandoned`: for ever.
class AbandonableThread {
 public:
  /// False: it is inside just now. [control]
  [[nodiscard]] bool abandon();
  [[nodiscard]] bool abandoned() const {
    return place_.load(std::memory_order_acquire) == Place::abandoned;
  }
  /// The hook it is in, "first.core on_configure"; empty: none. [any]
  [[nodiscard]] std::string hook() const;

  /// Of the calling thread; null: that thread is never abandoned.
  [[nodiscard]] static AbandonableThread* here();
  /// The calling thread is this one until it ends. It outlives the thread.
  void begin_here();

 private:
  friend class Inside;
  friend class InHook;
  enum class Place : std::uint8_t { outside, inside, abandoned };

  bool move(Place from, Place to);

  std::atomic<Place> place_{Place::outside};
  mutable Mutex mutex_;  // of the members below
  std::string hook_ MAUVE_GUARDED_BY(mutex_);
};

/// While it lives, the calling thread may use the model. False: the thread is abandoned.
class Inside {
 public:
  Inside();
  ~Inside();
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  explicit operator bool() const { return inside_; }

 private:
  AbandonableThread* const here_;
  bool inside_;
};

/// The calling thread is in a hook, and so outside, until back().
class InHook {
 public:
  InHook(const std::string& at, const char* hook);
  InHook(const InHook&) = delete;
  InHook& operator=(const InHook&) = delete;
  /// Once. False: the thread was abandoned meanwhile.
  [[nodiscard]] bool back();

 private:
  AbandonableThread* const here_;
  std::string before_;
  bool was_inside_ = false;
};

/// Is the calling thread abandoned?
[[nodiscard]] bool abandoned_here();

}  // namespace mauve
