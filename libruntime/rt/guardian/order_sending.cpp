// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/order_sending.h"

#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "rt/thread/futex.h"

namespace mauve::rt {
namespace {

constexpr int kRounds = 2;
constexpr Duration kBetweenTries{1ms};
constexpr Duration kBetweenLateTries{10ms};

}  // namespace

void OrderSending::begin(const guardian::Order& order, Instant now) {
  rounds_ = kRounds;
  late_ = false;
  begin_round(order, now);
}

void OrderSending::begin_round(const guardian::Order& order, Instant due) {
  begun_ = false;
  times_ = order.times;
  bytes_ = 0;
  due_ = due;
  until_ = due + kPatience.count();
}

Instant OrderSending::advance(const guardian::Order& order, int descriptor, Instant now) {
  while (under_way() && due_ <= now) {
    if (!std::exchange(begun_, true) && order.drop_unsent != 0) tcflush(descriptor, TCOFLUSH);
    if (!write_one(order, descriptor)) {
      if (errno != EAGAIN && errno != EINTR) {  // it is gone
        cancel();
        return kForever;
      }
      late_ = late_ || now >= until_;
      return now + (late_ ? kBetweenLateTries : kBetweenTries).count();
    }
    due_ += Duration{std::chrono::microseconds(order.apart_us)}.count();
    if (--times_ > 0) continue;
    if (--rounds_ > 0) begin_round(order, std::max(due_, now + kOnceMore.count()));
  }
  return under_way() ? due_ : kForever;
}

/// False with errno set: the rest of it is still to go.
bool OrderSending::write_one(const guardian::Order& order, int descriptor) {
  while (bytes_ < order.size) {
    const ssize_t count = ::write(descriptor, order.bytes.data() + bytes_, order.size - bytes_);
    if (count == 0) errno = EAGAIN;
    if (count <= 0) return false;
    bytes_ += static_cast<std::uint32_t>(count);
  }
  bytes_ = 0;
  return true;
}

}  // namespace mauve::rt
