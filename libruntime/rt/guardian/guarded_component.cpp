// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/guarded_component.h"

#include <algorithm>
#include <utility>

#include "rt/guardian/guarded_outputs.h"
#include "rt/process/cache.h"

namespace mauve::rt {

static_assert(guardian::kMostOutputs <= 32, "a bit for each");

std::array<OutputSlot, guardian::kMostOutputs> output_slots{};

GuardedComponent::GuardedComponent(std::string name) : name_(std::move(name)) {
  GuardedOutputs::of_process().join(*this);
}

GuardedComponent::~GuardedComponent() { GuardedOutputs::of_process().forget(*this); }

MAUVE_RUNS_AT_A_SWAP void GuardedComponent::change(const void* core, const void* shell,
                                                   bool commanded) {
  const void* const left_core = core_.load(std::memory_order_relaxed);
  const void* const left_shell = shell_.load(std::memory_order_relaxed);
  core_.store(core, std::memory_order_relaxed);
  shell_.store(shell, std::memory_order_relaxed);
  commanded_.store(commanded);
  if (left_core != core && left_core != nullptr) {
    left_.at(lefts_.fetch_add(1, std::memory_order_relaxed) % kLeft).store(left_core);
  }
  std::uint32_t left = 0;
  const std::uint32_t held = held_.load();
  for (std::uint32_t slot = 0; slot < output_slots.size() && held >> slot != 0; ++slot) {
    const void* const holder = output_slots[slot].holder.load(std::memory_order_relaxed);
    const bool leaves =
        (holder == left_core && holder != core) || (holder == left_shell && holder != shell);
    if ((held & bit(slot)) != 0 && (leaves || !commanded)) left |= bit(slot);
  }
  make_due(left);
}

void GuardedComponent::stand() {
  commanded_.store(false);
  make_due(held_.load());
}

void GuardedComponent::make_due(std::uint32_t slots) {
  if (slots == 0) return;
  for (std::uint32_t slot = 0; slots >> slot != 0; ++slot) {
    OutputSlot& one = output_slots[slot];
    // The next core commands the device: it is no order, and no command is overruled.
    if ((slots & bit(slot)) != 0 && !commands(one.device.load())) one.times_due.fetch_add(1);
  }
  due_.fetch_or(slots, std::memory_order_release);
  wake_order_sender();
}

bool GuardedComponent::owns(std::string_view address) const {
  return address.substr(0, address.find('.')) == name_;
}

void GuardedComponent::add(std::uint32_t slot) {
  due_.fetch_and(~bit(slot), std::memory_order_relaxed);
  held_.fetch_or(bit(slot));
  const void* const holder = output_slots.at(slot).holder.load();
  if (is_in_force(holder) ? !commanded_.load() : was_in_force(holder)) make_due(bit(slot));
}

bool GuardedComponent::was_in_force(const void* core) const {
  return std::any_of(left_.begin(), left_.end(), [core](const auto& one) { return one == core; });
}

void GuardedComponent::forget(const void* core) {
  for (auto& one : left_) {
    const void* its = core;
    one.compare_exchange_strong(its, nullptr);
  }
}

void GuardedComponent::remove(std::uint32_t slot) {
  held_.fetch_and(~bit(slot), std::memory_order_relaxed);
  due_.fetch_and(~bit(slot), std::memory_order_relaxed);
}

bool GuardedComponent::commands(std::uint64_t device) const {
  if (!commanded_.load(std::memory_order_acquire)) return false;
  const std::uint32_t held = held_.load(std::memory_order_relaxed);
  for (std::uint32_t slot = 0; slot < output_slots.size() && held >> slot != 0; ++slot) {
    const OutputSlot& one = output_slots.at(slot);
    if ((held & bit(slot)) != 0 && one.device.load() == device && is_in_force(one.holder.load())) {
      return true;
    }
  }
  return false;
}

}  // namespace mauve::rt
