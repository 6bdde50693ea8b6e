// SPDX-License-Identifier: LGPL-3.0-or-later
#include "orders.h"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "clock.h"
#include "say.h"

namespace mauve::guardian {
namespace {

constexpr std::int64_t kMostTime = wire::kMostTimeMs * kMillisecond;
constexpr std::int64_t kBetweenTries = kMillisecond / 2;
constexpr std::uint32_t kMostTimes = 10;

const char* fault_of(const wire::Order& order) {
  if (order.size == 0 || order.size > order.bytes.size()) return "an order has 1 to 256 bytes";
  if (order.times == 0 || order.times > kMostTimes) return "an order is sent 1 to 10 times";
  const std::uint64_t whole = std::uint64_t{order.times - 1} * order.apart_us;
  if (whole >= wire::kMostTimeMs * 1000) return "an order must have gone out after 100 ms";
  return nullptr;
}

bool never_waits(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags >= 0 && (flags & O_NONBLOCK) != 0;
}

}  // namespace

const char* Orders::hold(std::uint32_t slot, const wire::Order& order, int descriptor) {
  const char* wrong = slot < held_.size() ? fault_of(order) : "there is no such slot";
  if (wrong == nullptr && !never_waits(descriptor)) {
    wrong = "the descriptor must be open, and opened with O_NONBLOCK";
  }
  if (wrong != nullptr) {
    if (descriptor >= 0) close(descriptor);
    return wrong;
  }
  drop(slot);
  held_[slot].order = order;
  held_[slot].order.name.back() = '\0';
  held_[slot].descriptor = descriptor;
  return nullptr;
}

void Orders::drop(std::uint32_t slot) {
  if (slot >= held_.size() || held_[slot].descriptor < 0) return;
  close(held_[slot].descriptor);
  held_[slot] = Held{};
}

void Orders::drop_all() {
  for (std::uint32_t slot = 0; slot < held_.size(); ++slot) drop(slot);
}

std::uint32_t Orders::count() const {
  return static_cast<std::uint32_t>(std::count_if(
      held_.begin(), held_.end(), [](const Held& held) { return held.descriptor >= 0; }));
}

Sent Orders::send(const std::function<void()>& meanwhile) {
  const std::int64_t until = now() + kMostTime;
  for (Held& held : held_) {
    if (held.descriptor >= 0) begin(held, now());
  }
  for (bool all = false; !all && now() < until;) {
    all = true;
    for (Held& held : held_) {
      if (held.descriptor >= 0 && !advance(held, now())) all = false;
    }
    if (all) break;
    meanwhile();
    sleep_for(kBetweenTries);
  }
  Sent sent;
  for (const Held& held : held_) {
    if (held.descriptor < 0) continue;
    ++sent.total;
    if (held.times == held.order.times) {
      ++sent.whole;
    } else {
      report_failure(held);
      tcflush(held.descriptor, TCOFLUSH);  // else its close may wait for the device
    }
  }
  return sent;
}

/// A process that shares the descriptor may have made it wait since.
void Orders::begin(Held& held, std::int64_t now) {
  held.times = 0;
  held.bytes = 0;
  held.error = 0;
  held.due = now;
  const int flags = fcntl(held.descriptor, F_GETFL);
  if (flags >= 0) fcntl(held.descriptor, F_SETFL, flags | O_NONBLOCK);
  if (held.order.drop_unsent != 0) tcflush(held.descriptor, TCOFLUSH);
}

/// True when nothing is left to be done for it.
bool Orders::advance(Held& held, std::int64_t now) {
  while (held.times < held.order.times && held.due <= now) {
    const ssize_t count =
        write(held.descriptor, held.order.bytes.data() + held.bytes, held.order.size - held.bytes);
    if (count < 0) {
      held.error = errno;
      return errno != EAGAIN && errno != EINTR;
    }
    held.bytes += static_cast<std::uint32_t>(count);
    if (held.bytes < held.order.size) return false;
    held.bytes = 0;
    held.error = 0;
    ++held.times;
    held.due += std::int64_t{held.order.apart_us} * 1000;
  }
  return held.times == held.order.times;
}

void Orders::report_failure(const Held& held) {
  say("%s did not take its order (sent %u of %u times): %s. Its output may be live.",
      held.order.name.data(), held.times, held.order.times,
      held.error == 0 ? "it takes too long" : std::strerror(held.error));
}

}  // namespace mauve::guardian
