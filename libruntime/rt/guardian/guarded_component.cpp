// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/guarded_component.h"

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
  due_.fetch_or(slots, std::memory_order_release);
  wake_order_sender();
}

bool GuardedComponent::owns(std::string_view address) const {
  return address.substr(0, address.find('.')) == name_;
}

void GuardedComponent::add(std::uint32_t slot) {
  due_.fetch_and(~bit(slot), std::memory_order_relaxed);
  held_.fetch_or(bit(slot));
  if (!commanded_.load() && is_in_force(output_slots.at(slot).holder.load())) make_due(bit(slot));
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
