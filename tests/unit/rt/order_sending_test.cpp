// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/order_sending.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <string>

#include "rt/thread/futex.h"
#include "support/pipe_device.h"

namespace mauve::rt {
namespace {

using test::PipeDevice;

guardian::Order stand_order(std::uint32_t times = 1, Duration apart = {}) {
  const std::string bytes = "stand ";
  guardian::Order order;
  std::copy(bytes.begin(), bytes.end(), order.bytes.begin());
  order.size = static_cast<std::uint32_t>(bytes.size());
  order.times = times;
  order.apart_us = static_cast<std::uint32_t>(apart / Duration{1us});
  return order;
}

/// Sends it on a clock of its own; returns how long it took.
Duration send_whole(OrderSending& sending, const guardian::Order& order, int descriptor) {
  Instant now = 1'000'000'000;
  sending.begin(order, now);
  for (Instant next = now; next != kForever; next = sending.advance(order, descriptor, now)) {
    now = std::max(now, next);
  }
  return Duration{now - 1'000'000'000};
}

TEST(OrderSending, SendsAnOrderAsOftenAsItSaysAndThenOnceMore) {
  PipeDevice device;
  OrderSending sending;

  const Duration took = send_whole(sending, stand_order(3, 20ms), device.descriptor());

  EXPECT_EQ(device.bytes(), "stand stand stand stand stand stand ");
  EXPECT_GE(took, 90ms);
  EXPECT_LE(took, 200ms);
  EXPECT_FALSE(sending.under_way());
}

TEST(OrderSending, ReachesADeviceThatTakesNothingForLong) {
  PipeDevice device;
  device.fill();
  OrderSending sending;
  Instant now = 1'000'000'000;
  sending.begin(stand_order(), now);
  const auto advance_for = [&](Duration time) {
    const Instant end = now + time.count();
    while (now < end) now = std::min(sending.advance(stand_order(), device.descriptor(), now), end);
  };

  advance_for(OrderSending::kPatience / 2);
  EXPECT_FALSE(sending.late());
  advance_for(10s);
  EXPECT_TRUE(sending.late()) << "nobody waits for it any more";
  EXPECT_TRUE(sending.under_way());
  const std::size_t before = device.bytes().size();

  advance_for(1s);

  EXPECT_EQ(device.bytes().substr(before), "stand stand ");
  EXPECT_FALSE(sending.under_way());
}

TEST(OrderSending, GivesUpADeviceThatIsGone) {
  std::signal(SIGPIPE, SIG_IGN);
  PipeDevice device;
  device.hang_up();
  OrderSending sending;

  EXPECT_LT(send_whole(sending, stand_order(), device.descriptor()), OrderSending::kPatience);
}

}  // namespace
}  // namespace mauve::rt
