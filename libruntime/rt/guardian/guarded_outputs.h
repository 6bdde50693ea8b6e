// SPDX-License-Identifier: LGPL-3.0-or-later
/// GuardedOutputs: the outputs that the guardian of this process holds for it (guardian/README.md).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/guarded.h>
#include <mauve/result.h>

#include "base/mutex.h"
#include "rt/guardian/guardian_wire.h"
#include "rt/guardian/order_sending.h"
#include "rt/process/descriptor.h"
#include "rt/thread/thread.h"

namespace mauve::rt {

class GuardedComponent;

/// The fate of an output that no guardian holds.
enum class GuardianUse : std::uint8_t {
  off,     ///< no guardian is looked for
  prefer,  ///< it works without one
  require  ///< it is refused
};

/// An order is due: wakes the thread that sends it. [rt] One system call.
void wake_order_sender();

/// All outputs of the process that are to be guarded. Sends their orders while this process lives,
/// when they are due (guarded_component.h). Keeps a copy of each descriptor, so that a guardian
/// that comes later gets it. Not on real-time threads.
class GuardedOutputs {
 public:
  static GuardedOutputs& of_process();

  /// The `holder` is the core or shell that declares the owner, and `name` is its address.
  struct Owner {
    const void* owner = nullptr;
    const void* holder = nullptr;
    std::string name;
  };
  /// Holds the order in place of the one that this owner had. Waits for the answer of the guardian,
  /// or until one was looked for, 2 s at most. Refused when it cannot be an order, and under
  /// `require` when no guardian has it then. [any]
  Status hold(const Owner& owner, int descriptor, const SafeOrder& order);
  /// Drops the order of this owner, if it has one. Waits until an order that is on its way has gone
  /// out, some 200 ms at most. When it returns, nothing is sent to that descriptor any more, or the
  /// guardian did not answer within a second. [any]
  void drop(const void* owner);
  /// The order of this owner goes out again, unless a job commands its device. [any but rt]
  void repeat(const void* owner);
  /// See OutputSlot; null: the owner holds nothing. [any but rt]
  [[nodiscard]] const std::atomic<std::uint32_t>* times_due(const void* owner) const;
  /// The core or shell is destroyed. [any but rt]
  void forget_holder(const void* holder);
  /// Lets the guardian send all orders again: an output that was made safe may have been live
  /// since. [any] Never waits.
  void send_again();
  /// The component of some outputs; outputs and components come in any order. [any but rt]
  void join(GuardedComponent& component);
  /// Its orders that are due still go out. No thread reads it after this call. [any but rt]
  void forget(GuardedComponent& component);
  /// The names of those that a guardian holds, or would if there were one. [any]
  [[nodiscard]] std::vector<std::string> names() const;

  // --- Of the thread that has the connection (guardian_link.h).
  /// From now on orders are kept; `ring` is called for the first one of them. `priority`:
  /// SCHED_FIFO of [safe], where it is permitted. To be ended by say_goodbye() or leave(). [any]
  Status expect(GuardianUse use, std::function<void()> ring, int priority = 0);
  /// The socket of the guardian that was found; -1: there is none.
  void attach(int socket);
  void detach();
  void take(const guardian::Answer& answer);
  /// The end in order, once all orders on their way have gone out: nothing is sent any more, and
  /// from now on nothing is kept. [any]
  void say_goodbye();
  /// Without a word: the guardian shall send its orders. From now on nothing is kept. [any]
  void leave();

 private:
  struct Held {
    guardian::Order order;
    Descriptor descriptor;
    std::uint32_t slot = 0;
    std::uint32_t number = 0;  // of the request that hands it over
    bool answered = false;     // by the present guardian
    std::string refused;       // the refusal of the guardian; empty: none
    OrderSending sending;      // of this process itself
    std::uint64_t device = 0;  // see OutputSlot
  };
  [[nodiscard]] Result<Held> made(const Owner& owner, int descriptor, const SafeOrder& order) const
      MAUVE_REQUIRES(mutex_);
  void clear(std::uint32_t slot) MAUVE_REQUIRES(mutex_);
  void hand_over(Held& held) MAUVE_REQUIRES(mutex_);
  std::uint32_t send(guardian::Request request, int descriptor) MAUVE_REQUIRES(mutex_);
  void await(MutexLock& lock, std::uint32_t number) MAUVE_REQUIRES(mutex_);
  void await_sending(MutexLock& lock, const void* owner) MAUVE_REQUIRES(mutex_);
  void run_sender();
  void begin_due(GuardedComponent& component) MAUVE_REQUIRES(mutex_);
  [[nodiscard]] Instant advance(Held& held, Instant now) MAUVE_REQUIRES(mutex_);

  mutable Mutex mutex_;  // of all that follows
  ConditionVariable changed_;
  bool keeps_ MAUVE_GUARDED_BY(mutex_) = false;
  GuardianUse use_ MAUVE_GUARDED_BY(mutex_) = GuardianUse::off;
  std::function<void()> ring_ MAUVE_GUARDED_BY(mutex_);
  bool looked_ MAUVE_GUARDED_BY(mutex_) = false;  // for a guardian
  int socket_ MAUVE_GUARDED_BY(mutex_) = -1;      // the link's; -1: no guardian
  std::uint32_t number_ MAUVE_GUARDED_BY(mutex_) = 0;
  std::uint32_t answered_ MAUVE_GUARDED_BY(mutex_) = 0;  // all up to this one
  std::map<const void*, Held> held_ MAUVE_GUARDED_BY(mutex_);
  std::vector<GuardedComponent*> components_ MAUVE_GUARDED_BY(mutex_);
  std::atomic<bool> sender_ends_{false};
  Thread sender_;  // of orders that are due
};

}  // namespace mauve::rt
