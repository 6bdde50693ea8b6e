// SPDX-License-Identifier: LGPL-3.0-or-later
/// GuardedComponent: the guarded outputs of one component, and when their orders are due.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "rt/guardian/guardian_wire.h"

namespace mauve::rt {

/// The part of a guarded output that threads without a lock read.
struct OutputSlot {
  std::atomic<const void*> holder{nullptr};  ///< the core or shell that declares it; null: none
  std::atomic<std::uint64_t> device{0};      ///< the same number for each way to the device
  std::atomic<std::uint32_t> times_due{0};   ///< how often no job commanded it any more
};
/// By number; the bits below are in this order.
extern std::array<OutputSlot, guardian::kMostOutputs> output_slots;

/// Knows the outputs of a component, whether its jobs command them, and which orders are due. An
/// order is due when no job commands the output any more. That is so at a stop, at a fault before
/// anything recovers it, and when the next core holds another device. It goes out unless a
/// component commands that device by then. GuardedOutputs sends it.
class GuardedComponent {
 public:
  /// Begins without a core. [any but rt]
  explicit GuardedComponent(std::string name);
  /// The orders that are due go out all the same. [any but rt]
  ~GuardedComponent();
  GuardedComponent(const GuardedComponent&) = delete;
  GuardedComponent& operator=(const GuardedComponent&) = delete;

  /// The component has this core and this shell from now on. `commanded`: by its jobs. Orders of
  /// the core before are due, and all if no job commands. [rt] One system call at most.
  void put_in_force(const void* core, const void* shell, bool commanded) {
    const bool same = is_in_force(core) && is_in_force(shell) &&
                      commanded_.load(std::memory_order_relaxed) == commanded;
    if (!same) change(core, shell, commanded);
  }
  /// No job commands the outputs from now on, or any more: all orders are due. [any]
  void stand();
  /// A job that mauved had abandoned has ended, and may have commanded since the orders went out:
  /// all are due once more, but for a device that another job commands. [any]
  void repeat() { make_due(held_.load()); }
  [[nodiscard]] bool holds_any() const { return held_.load(std::memory_order_relaxed) != 0; }

  // --- Of GuardedOutputs, under its lock.
  /// Is the output with this address one of the component?
  [[nodiscard]] bool owns(std::string_view address) const;
  /// A device that came back still has its last command. So its order is due at once if the core in
  /// force holds it and no job commands, or if a core holds it that was in force before.
  void add(std::uint32_t slot);
  void remove(std::uint32_t slot);
  /// There is no such core any more.
  void forget(const void* core);
  [[nodiscard]] std::uint32_t take_due() { return due_.exchange(0, std::memory_order_acquire); }
  [[nodiscard]] bool is_due(std::uint32_t slot) const { return (due_.load() & bit(slot)) != 0; }
  [[nodiscard]] bool commands(std::uint64_t device) const;

  static constexpr std::uint32_t bit(std::uint32_t slot) { return 1U << slot; }

 private:
  static constexpr std::size_t kLeft = 4;  // the newest ones; those of a probation are not more

  [[nodiscard]] bool was_in_force(const void* core) const;
  [[nodiscard]] bool is_in_force(const void* holder) const {
    return core_.load(std::memory_order_relaxed) == holder ||
           shell_.load(std::memory_order_relaxed) == holder;
  }
  void change(const void* core, const void* shell, bool commanded);
  void make_due(std::uint32_t slots);

  const std::string name_;
  // An output that is added, and a job that ceases to command, meet on two threads. Each of them
  // stores its own fact first, and then looks at that of the other one.
  std::atomic<std::uint32_t> held_{0};  // by slots, as the next one
  std::atomic<std::uint32_t> due_{0};
  std::atomic<const void*> core_{nullptr};
  std::atomic<const void*> shell_{nullptr};
  std::array<std::atomic<const void*>, kLeft> left_{};  // cores that were in force
  std::atomic<std::uint32_t> lefts_{0};
  std::atomic<bool> commanded_{false};
};

}  // namespace mauve::rt
