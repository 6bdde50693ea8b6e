// SPDX-License-Identifier: LGPL-3.0-or-later
/// A thread that runs user code for others. When that never returns it is left behind: from then on
/// it may put away what it made itself, and nothing else.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "base/mutex.h"

namespace mauve {

/// How it stands to the model, which others use too:
///   outside  in user code, or with things of its own: it can be left behind
///   inside   uses the model, for a bounded time: who wants to leave it asks again
///   left     for ever
class Leavable {
 public:
  /// False: it is inside just now. [control]
  [[nodiscard]] bool leave();
  [[nodiscard]] bool left() const { return place_.load(std::memory_order_acquire) == Place::left; }
  /// The hook it is in, "first.core on_configure"; empty: none. [any]
  [[nodiscard]] std::string hook() const;

  /// The calling thread's; null: nobody ever leaves that thread.
  [[nodiscard]] static Leavable* here();
  /// The calling thread is this one until it ends. It outlives the thread.
  void begin_here();

 private:
  friend class Inside;
  friend class InHook;
  enum class Place : std::uint8_t { outside, inside, left };

  bool move(Place from, Place to);

  std::atomic<Place> place_{Place::outside};
  mutable Mutex mutex_;  // of what follows
  std::string hook_ MAUVE_GUARDED_BY(mutex_);
};

/// While it lives, the calling thread may use the model. False: it was left behind.
class Inside {
 public:
  Inside();
  ~Inside();
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  explicit operator bool() const { return inside_; }

 private:
  Leavable* const here_;
  bool inside_;
};

/// The calling thread is in a hook, and so outside, until back().
class InHook {
 public:
  InHook(const std::string& at, const char* hook);
  InHook(const InHook&) = delete;
  InHook& operator=(const InHook&) = delete;
  /// Once. False: it was left behind meanwhile.
  [[nodiscard]] bool back();

 private:
  Leavable* const here_;
  std::string before_;
  bool was_inside_ = false;
};

/// Was the calling thread left behind?
[[nodiscard]] bool left_here();

}  // namespace mauve
