// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/guarded_outputs.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <mauve/host/clock.h>

#include "base/mutex.h"
#include "rt/guardian/guarded_component.h"
#include "rt/guardian/guardian_link.h"
#include "rt/process/pulse.h"
#include "rt/thread/futex.h"

namespace mauve::rt {
namespace {

constexpr Duration kToBeFound = 2s;
constexpr Duration kToAnswer = 1s;
constexpr int kMostTimes = 10;

Status check(const SafeOrder& order) {
  if (order.bytes.empty() || order.bytes.size() > guardian::kMostBytes) {
    return refuse({Errc::invalid_value, "safe_order_invalid"}, {},
                  "a safe order has 1 to 256 bytes");
  }
  const Duration most = std::chrono::milliseconds(guardian::kMostTimeMs);
  const bool in_time = order.apart >= Duration{0} && order.apart * (order.times - 1) < most;
  if (order.times < 1 || order.times > kMostTimes || !in_time) {
    return refuse({Errc::invalid_value, "safe_order_invalid"}, {},
                  "a safe order is sent 1 to 10 times, all of them within 100 ms");
  }
  return ok();
}

/// Cut to the room there is.
template <std::size_t N>
void copy_into(std::array<char, N>& room, const std::string& text) {
  const std::size_t length = std::min(text.size(), N - 1);
  std::memcpy(room.data(), text.data(), length);
  room[length] = '\0';
}

/// The same for each way to the device: a link, a name in another folder.
std::uint64_t device_of(int descriptor) {
  struct stat facts {};
  if (fstat(descriptor, &facts) != 0) return 0;
  constexpr unsigned kSystem = 48;  // the file system; devices and their names are few
  return S_ISCHR(facts.st_mode) ? facts.st_rdev : facts.st_ino ^ facts.st_dev << kSystem;
}

std::atomic<std::uint32_t> sender_bell{0};  // of the thread that sends orders
constexpr Duration kToGoOut = 500ms;

/// A guardian that is deaf is as good as none: the link finds the connection ended, and looks for
/// another.
void give_up(int socket) {
  if (socket >= 0) shutdown(socket, SHUT_RDWR);
}

}  // namespace

void wake_order_sender() { futex_bump(sender_bell); }

GuardedOutputs& GuardedOutputs::of_process() {
  static auto* const all = new GuardedOutputs;  // plugins may drop theirs at the very end
  return *all;
}

Status GuardedOutputs::expect(GuardianUse use, std::function<void()> ring, int priority) {
  {
    const MutexLock lock(mutex_);
    keeps_ = true;
    use_ = use;
    ring_ = std::move(ring);
    looked_ = use == GuardianUse::off;
  }
  sender_ends_ = false;
  if (sender_.running()) return ok();
  return sender_.start({"mauve-safe", 0, {}, 64 * 1024}, [this, priority] {
    raise_this_thread(priority);
    run_sender();
  });
}

Result<GuardedOutputs::Held> GuardedOutputs::made(const Owner& owner, int descriptor,
                                                  const SafeOrder& order) const {
  Held held;
  copy_into(held.order.name, owner.name);
  std::copy(order.bytes.begin(), order.bytes.end(), held.order.bytes.begin());
  held.order.size = static_cast<std::uint32_t>(order.bytes.size());
  held.order.times = static_cast<std::uint32_t>(order.times);
  held.order.apart_us = static_cast<std::uint32_t>(order.apart / Duration{1us});
  held.order.drop_unsent = order.drop_unsent ? 1 : 0;
  const auto claimed = [&]() MAUVE_REQUIRES(mutex_) {
    return std::any_of(held_.begin(), held_.end(),
                       [&](const auto& one) { return one.second.slot == held.slot; });
  };
  const auto before = held_.find(owner.owner);
  if (before != held_.end()) {
    held.slot = before->second.slot;
  } else {
    while (claimed()) ++held.slot;
  }
  if (held.slot >= guardian::kMostOutputs) {
    return refuse({Errc::limit, "guardian_full"}, {}, "a guardian holds no more than 32 outputs");
  }
  if ((fcntl(descriptor, F_GETFL) & O_NONBLOCK) == 0) {
    return refuse({Errc::invalid_value, "output_not_guarded"}, {},
                  "its descriptor must be opened with O_NONBLOCK");
  }
  held.descriptor = Descriptor(fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (!held.descriptor) {
    return refuse({Errc::system, "guardian_failed"}, {},
                  "its descriptor cannot be copied: " + std::generic_category().message(errno));
  }
  held.device = device_of(descriptor);
  return held;
}

Status GuardedOutputs::hold(const Owner& by, int descriptor, const SafeOrder& order) {
  if (Status right = check(order); !right) return right;
  const void* const owner = by.owner;
  MutexLock lock(mutex_);
  if (!keeps_) return ok();
  auto next = made(by, descriptor, order);
  if (!next) return next.error();
  Held& held = held_[owner] = *std::move(next);
  OutputSlot& slot = output_slots.at(held.slot);
  slot.holder = by.holder;
  slot.device = held.device;
  for (GuardedComponent* component : components_) {
    if (component->owns(by.name)) component->add(held.slot);
  }
  if (socket_ >= 0) {
    hand_over(held);
  } else if (ring_) {
    ring_();
  }
  const auto settled = [&]() MAUVE_REQUIRES(mutex_) {  // its slot may be released meanwhile
    const auto found = held_.find(owner);
    return found == held_.end() || found->second.answered || !found->second.refused.empty() ||
           (looked_ && socket_ < 0);
  };
  if (!changed_.wait_for(lock, looked_ ? kToAnswer : kToBeFound, settled)) give_up(socket_);
  const auto found = held_.find(owner);
  if (found == held_.end()) return ok();
  std::string why = found->second.refused;
  if (why.empty() && !found->second.answered && use_ == GuardianUse::require) {
    why = "no guardian holds this output, and mauved --guardian require asks for one";
  }
  if (why.empty()) return ok();
  await_sending(lock, owner);  // of a device that came back while no job commands
  if (const auto left = held_.find(owner); left != held_.end()) {
    clear(left->second.slot);
    held_.erase(left);
  }
  return refuse({Errc::invalid_value, "output_not_guarded"}, {}, why,
                "see mauvectl doctor, and man mauve-guardian");
}

void GuardedOutputs::drop(const void* owner) {
  MutexLock lock(mutex_);
  await_sending(lock, owner);
  const auto found = held_.find(owner);
  if (found == held_.end()) return;
  const std::uint32_t slot = found->second.slot;
  if (socket_ >= 0) {
    guardian::Request request;
    request.kind = guardian::Kind::drop;
    request.slot = slot;
    const std::uint32_t number = send(request, -1);
    await(lock, number);
  }
  clear(slot);
  held_.erase(owner);
}

void GuardedOutputs::repeat(const void* owner) {
  {
    const MutexLock lock(mutex_);
    const auto found = held_.find(owner);
    if (found == held_.end()) return;
    found->second.sending.begin(found->second.order, MonotonicClock().now());
  }
  wake_order_sender();
}

const std::atomic<std::uint32_t>* GuardedOutputs::times_due(const void* owner) const {
  const MutexLock lock(mutex_);
  const auto found = held_.find(owner);
  return found == held_.end() ? nullptr : &output_slots.at(found->second.slot).times_due;
}

void GuardedOutputs::forget_holder(const void* holder) {
  const MutexLock lock(mutex_);
  for (GuardedComponent* component : components_) component->forget(holder);
}

void GuardedOutputs::clear(std::uint32_t slot) {
  for (GuardedComponent* component : components_) component->remove(slot);
  output_slots.at(slot).holder = nullptr;
}

void GuardedOutputs::send_again() {
  const MutexLock lock(mutex_);
  if (socket_ < 0) return;
  guardian::Request request;
  request.kind = guardian::Kind::again;
  send(request, -1);
}

std::vector<std::string> GuardedOutputs::names() const {
  const MutexLock lock(mutex_);
  std::vector<std::string> all;
  if (use_ == GuardianUse::off) return all;
  all.reserve(held_.size());
  for (const auto& [owner, held] : held_) all.emplace_back(held.order.name.data());
  std::sort(all.begin(), all.end());
  return all;
}

void GuardedOutputs::attach(int socket) {
  const MutexLock lock(mutex_);
  socket_ = socket;
  looked_ = true;
  for (auto& [owner, held] : held_) {
    if (socket >= 0) hand_over(held);
  }
  changed_.notify_all();
}

void GuardedOutputs::detach() {
  const MutexLock lock(mutex_);
  socket_ = -1;
  looked_ = false;  // another one is looked for at once
  for (auto& [owner, held] : held_) held.answered = false;
  changed_.notify_all();
}

void GuardedOutputs::take(const guardian::Answer& answer) {
  const MutexLock lock(mutex_);
  answered_ = answer.number;
  for (auto& [owner, held] : held_) {
    if (held.number != answer.number) continue;
    held.answered = answer.done != 0;
    held.refused = answer.done != 0 ? "" : "the guardian refuses it: ";
    if (answer.done == 0) held.refused += answer.text.data();
  }
  changed_.notify_all();
}

void GuardedOutputs::say_goodbye() {
  {
    MutexLock lock(mutex_);
    keeps_ = false;
    await_sending(lock, nullptr);
    if (socket_ >= 0) {
      guardian::Request request;
      request.kind = guardian::Kind::bye;
      await(lock, send(request, -1));
    }
  }
  leave();
}

void GuardedOutputs::leave() {
  {
    const MutexLock lock(mutex_);
    keeps_ = false;
    use_ = GuardianUse::off;
    ring_ = nullptr;
    for (const auto& [owner, held] : held_) clear(held.slot);
    held_.clear();
    changed_.notify_all();
  }
  sender_ends_ = true;
  futex_bump(sender_bell);
  sender_.join();
}

void GuardedOutputs::join(GuardedComponent& component) {
  const MutexLock lock(mutex_);
  components_.push_back(&component);
  for (const auto& [owner, held] : held_) {
    if (component.owns(held.order.name.data())) component.add(held.slot);
  }
}

void GuardedOutputs::forget(GuardedComponent& component) {
  {
    const MutexLock lock(mutex_);
    begin_due(component);
    std::erase(components_, &component);
  }
  wake_order_sender();
}

void GuardedOutputs::run_sender() {
  Pulse pulse("safe");
  while (!sender_ends_.load()) {
    pulse.turn();
    const std::uint32_t seen = sender_bell.load();
    Instant next = kForever;
    {
      const MutexLock lock(mutex_);
      for (GuardedComponent* component : components_) begin_due(*component);
      for (auto& [owner, held] : held_) {
        next = std::min(next, advance(held, MonotonicClock().now()));
      }
      changed_.notify_all();
    }
    const Instant turn = MonotonicClock().now() + Pulse::kTurn.count();
    futex_wait_until(sender_bell, seen, std::min(next, turn));
  }
}

void GuardedOutputs::begin_due(GuardedComponent& component) {
  const std::uint32_t due = component.take_due();
  if (due == 0) return;
  for (auto& [owner, held] : held_) {
    if ((due & GuardedComponent::bit(held.slot)) == 0) continue;
    held.sending.begin(held.order, MonotonicClock().now());
  }
}

/// When to look at it again.
Instant GuardedOutputs::advance(Held& held, Instant now) {
  if (!held.sending.under_way()) return kForever;
  const bool commanded =
      std::any_of(components_.begin(), components_.end(),
                  [&](const GuardedComponent* one) { return one->commands(held.device); });
  if (commanded) {
    held.sending.cancel();
    return kForever;
  }
  return held.sending.advance(held.order, held.descriptor.get(), now);
}

/// Of this owner, or of all (null). When the thread that sends them gets no processor, this one
/// sends them once.
void GuardedOutputs::await_sending(MutexLock& lock, const void* owner) {
  const auto goes_out = [&](const Held& held) MAUVE_REQUIRES(mutex_) {
    return (held.sending.under_way() && !held.sending.late()) ||
           std::any_of(components_.begin(), components_.end(),
                       [&](const GuardedComponent* one) { return one->is_due(held.slot); });
  };
  const auto gone_out = [&]() MAUVE_REQUIRES(mutex_) {
    return std::none_of(held_.begin(), held_.end(), [&](const auto& one) MAUVE_REQUIRES(mutex_) {
      return (owner == nullptr || one.first == owner) && goes_out(one.second);
    });
  };
  if (changed_.wait_for(lock, kToGoOut, gone_out)) return;
  for (GuardedComponent* component : components_) begin_due(*component);
  for (auto& [its, held] : held_) {
    if (owner == nullptr || its == owner) static_cast<void>(advance(held, MonotonicClock().now()));
  }
}

void GuardedOutputs::hand_over(Held& held) {
  guardian::Request request;
  request.kind = guardian::Kind::hold;
  request.slot = held.slot;
  request.order = held.order;
  held.answered = false;
  held.refused.clear();
  held.number = send(request, held.descriptor.get());
}

std::uint32_t GuardedOutputs::send(guardian::Request request, int descriptor) {
  request.number = ++number_;
  if (!guardian::send(socket_, request, descriptor)) give_up(socket_);
  return number_;
}

void GuardedOutputs::await(MutexLock& lock, std::uint32_t number) {
  const auto answered = [&]() MAUVE_REQUIRES(mutex_) { return socket_ < 0 || answered_ >= number; };
  if (!changed_.wait_for(lock, kToAnswer, answered)) give_up(socket_);
}

}  // namespace mauve::rt
