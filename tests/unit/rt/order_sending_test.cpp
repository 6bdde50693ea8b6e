// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/order_sending.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <string>
#include <utility>

#include <mauve/host/report.h>

#include "rt/guardian/guarded_outputs.h"
#include "rt/thread/futex.h"
#include "support/eventually.h"

namespace mauve::rt {
namespace {

/// A device that is a pipe.
class PipeDevice {
 public:
  PipeDevice() { EXPECT_EQ(pipe2(ends_.data(), O_NONBLOCK | O_CLOEXEC), 0); }
  ~PipeDevice() {
    hang_up();
    close(ends_[1]);
  }
  PipeDevice(const PipeDevice&) = delete;
  PipeDevice& operator=(const PipeDevice&) = delete;

  [[nodiscard]] int descriptor() const { return ends_[1]; }
  const std::string& bytes() {
    std::array<char, 4096> some{};
    for (ssize_t n = 0; (n = read(ends_[0], some.data(), some.size())) > 0;) {
      bytes_.append(some.data(), static_cast<std::size_t>(n));
    }
    return bytes_;
  }
  void fill() const {
    const std::string much(4096, 'x');
    while (write(ends_[1], much.data(), much.size()) > 0) {
    }
  }
  void hang_up() {
    if (ends_[0] >= 0) close(std::exchange(ends_[0], -1));
  }

 private:
  std::array<int, 2> ends_{};
  std::string bytes_;
};

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

TEST(OrderSending, GivesUpADeviceThatTakesNothing) {
  PipeDevice device;
  device.fill();
  OrderSending sending;

  const Duration took = send_whole(sending, stand_order(), device.descriptor());

  EXPECT_GE(took, OrderSending::kPatience);
  EXPECT_LE(took, 2 * OrderSending::kPatience);
}

TEST(OrderSending, GivesUpADeviceThatIsGone) {
  std::signal(SIGPIPE, SIG_IGN);
  PipeDevice device;
  device.hang_up();
  OrderSending sending;

  EXPECT_LT(send_whole(sending, stand_order(), device.descriptor()), OrderSending::kPatience);
}

/// The outputs of this process, with no guardian.
class SafeOrders : public testing::Test {
 protected:
  SafeOrders() { EXPECT_TRUE(outputs_.expect(GuardianUse::off, nullptr)); }
  ~SafeOrders() override { outputs_.leave(); }

  [[nodiscard]] Status hold(const std::string& name) {
    return outputs_.hold(this, name, device_.descriptor(), {.bytes = "stand "});
  }
  void stop(const std::string& component) {
    state_ = ComponentState::stopped;
    send_safe_orders(guarded_key(component), state_);
  }
  [[nodiscard]] bool gets(const std::string& bytes) {
    return test::eventually([&] { return device_.bytes() == bytes; });
  }

  GuardedOutputs& outputs_ = GuardedOutputs::of_process();
  PipeDevice device_;
  std::atomic<ComponentState> state_{ComponentState::running};
};

TEST_F(SafeOrders, GoOutWhenTheirComponentStops) {
  ASSERT_TRUE(hold("drives.core.stand"));

  stop("drives");

  EXPECT_TRUE(gets("stand stand "));
}

TEST_F(SafeOrders, OfOtherComponentsStay) {
  ASSERT_TRUE(hold("drives.core.stand"));

  stop("drive");
  stop("drives2");
  outputs_.drop(this);

  EXPECT_EQ(device_.bytes(), "");
}

TEST_F(SafeOrders, GoOutBeforeTheDeviceIsLetGo) {
  ASSERT_TRUE(hold("drives.core.stand"));

  stop("drives");
  outputs_.drop(this);

  EXPECT_EQ(device_.bytes(), "stand stand ");
}

TEST_F(SafeOrders, GoOutAlsoWhenTheComponentGoesAtOnce) {
  ASSERT_TRUE(hold("drives.core.stand"));

  stop("drives");
  outputs_.forget(state_);
  state_ = ComponentState::running;  // another one, in the same memory
  outputs_.drop(this);

  EXPECT_EQ(device_.bytes(), "stand stand ");
}

TEST_F(SafeOrders, DoNotDisturbAComponentThatRunsAgain) {
  ASSERT_TRUE(hold("drives.core.stand"));
  stop("drives");
  ASSERT_TRUE(gets("stand ") || gets("stand stand "));
  state_ = ComponentState::running;
  outputs_.drop(this);
  const std::string before = device_.bytes();

  EXPECT_TRUE(hold("drives.core.stand"));
  send_safe_orders(guarded_key("drives"), state_);
  outputs_.drop(this);

  EXPECT_EQ(device_.bytes(), before);
}

TEST_F(SafeOrders, GoOutBeforeAnEndInOrder) {
  ASSERT_TRUE(hold("drives.core.stand"));

  stop("drives");
  outputs_.say_goodbye();

  EXPECT_EQ(device_.bytes(), "stand stand ");
}

TEST_F(SafeOrders, AreRefusedForADescriptorThatWouldMakeTheThreadWait) {
  fcntl(device_.descriptor(), F_SETFL, 0);

  const Status held = hold("drives.core.stand");

  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().message, testing::HasSubstr("O_NONBLOCK"));
}

}  // namespace
}  // namespace mauve::rt
