// SPDX-License-Identifier: LGPL-3.0-or-later
#include "line_core.h"

#include <sys/eventfd.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>

namespace mauve::test {
namespace {

std::string numbered(std::size_t size) {
  std::string text;
  for (int i = 0; text.size() < size; ++i) text += std::to_string(i) + " ";
  return text.substr(0, size);
}

TEST_F(Line, BringsBytesBothWaysInTheirOrder) {
  const std::string text = numbered(100'000);  // around the end of its ring, several times
  LineBytes bytes;
  Core core(far_.device());
  std::string came;
  std::string_view left = text;
  ASSERT_TRUE(eventually([&] {
    left.remove_prefix(far_.send_some(left));
    return (came += core.job(bytes)).size() == text.size();
  }));
  EXPECT_EQ(came, text);

  std::string sent;
  for (int i = 0; i < 1000; ++i) {
    const std::string request = std::to_string(i) + "\n";
    ASSERT_TRUE(eventually([&] { return core.line.send(request); }));
    sent += request;
    if (i % 100 == 99) {
      EXPECT_EQ(heard(far_, sent.size()), sent);
      sent.clear();
    }
  }
}

TEST_F(Line, LeavesInTheDeviceWhatItsReaderHasNoRoomFor) {
  const std::string text = numbered(100'000);
  LineBytes bytes;
  Core core(far_.device());
  core.line.fill(bytes);
  std::string_view left = text;
  // Nobody takes a byte: first the ring is full, then the terminal.
  ASSERT_TRUE(eventually([&] {
    const std::size_t sent = far_.send_some(left);
    left.remove_prefix(sent);
    return bytes.ring.size() == decltype(bytes.ring)::kCapacity && sent == 0;
  }));
  ASSERT_FALSE(left.empty());
  std::string came;
  ASSERT_TRUE(eventually([&] {
    left.remove_prefix(far_.send_some(left));
    return (came += core.job(bytes)).size() == text.size();
  }));

  EXPECT_EQ(came, text) << "and nothing is lost";
}

TEST_F(Line, TakesNoMoreAndNeverHalfARequestWhenTheFarEndHangs) {
  Core core(far_.device());
  const std::string request = "0123456";  // 7 divides no power of two
  std::size_t sent = 0;
  // Until the terminal is full, and then the ring: from then on all is refused.
  std::size_t refused = 0;
  ASSERT_TRUE(eventually([&] {
    const bool accepted = core.line.send(request);
    sent += accepted ? 1 : 0;
    refused = accepted ? 0 : refused + 1;
    return refused == 100;
  }));
  EXPECT_FALSE(core.line.send(request));

  const std::string all = heard(far_, sent * request.size());
  ASSERT_EQ(all.size(), sent * request.size());
  for (std::size_t at = 0; at < all.size(); at += request.size()) {
    ASSERT_EQ(all.substr(at, request.size()), request);
  }
  EXPECT_TRUE(core.line.send("back"));
  EXPECT_EQ(heard(far_, 4), "back");
}

TEST_F(Line, TakesNothingBeforeItsFirstJob) {
  LineBytes bytes;
  Core prepared(far_.device());
  Core running(far_.device());
  ASSERT_TRUE(far_.send("for the one that runs"));

  EXPECT_EQ(running.jobs(bytes, 21), "for the one that runs");
}

TEST_F(Line, ASuccessorReadsOnWhereItsPredecessorStopped) {
  const std::string text = numbered(60'000);
  auto first = std::make_unique<Core>(far_.device());
  auto second = std::make_unique<Core>(far_.device());
  auto bytes = std::make_unique<LineBytes>();
  std::string came;
  std::string_view left = text;
  // To and fro at any byte, as changes and their way back.
  for (int change = 0; change < 20; ++change) {
    Core& core = change % 2 == 0 ? *first : *second;
    const std::size_t until = text.size() * static_cast<std::size_t>(change + 1) / 20;
    ASSERT_TRUE(eventually([&] {
      left.remove_prefix(far_.send_some(left.substr(0, 300)));
      return (came += core.job(*bytes)).size() >= until;
    }));
  }
  EXPECT_EQ(came, text);

  // The one that holds the bytes goes first, though the other may be filling them.
  static_cast<void>(first->job(*bytes));
  first->line.stop();
  second->line.stop();
  first->line.empty_handed(*bytes);
  bytes.reset();
}

TEST_F(Line, HasOneFillerHoweverOftenCoresFollowEachOther) {
  const std::string text = numbered(40'000);
  Core first(far_.device());
  Core second(far_.device());
  auto bytes = std::make_unique<LineBytes>();
  std::string came;
  std::string_view left = text;
  // A core is wanted again while its line lets go of the bytes.
  for (int change = 0; change < 5'000; ++change) {
    Core& core = change % 2 == 0 ? first : second;
    left.remove_prefix(far_.send_some(left.substr(0, 7)));
    for (int job = 0; job <= change % 5; ++job) came += core.job(*bytes);
  }
  ASSERT_TRUE(eventually([&] {
    left.remove_prefix(far_.send_some(left));
    return (came += first.job(*bytes)).size() >= text.size();
  }));
  EXPECT_EQ(came, text);

  first.line.stop();
  second.line.stop();
  first.line.empty_handed(*bytes);
  second.line.empty_handed(*bytes);
  bytes.reset();
}

TEST_F(Line, FillsACopyOfTheBytesAnew) {
  LineBytes before;
  LineBytes after;
  Core core(far_.device());
  ASSERT_TRUE(far_.send("one"));
  EXPECT_EQ(core.jobs(before, 3), "one");
  after = before;

  EXPECT_EQ(core.job(after), "");
  core.line.empty_handed(before);  // it has let go of them
  ASSERT_TRUE(far_.send("two"));

  EXPECT_EQ(core.jobs(after, 3), "two");
}

TEST_F(Line, SendsWhatWaitsBeforeItEnds) {
  for (int i = 0; i < 50; ++i) {
    Core core(far_.device());
    EXPECT_TRUE(core.line.send("stand"));
    core.line.stop();
    std::array<char, 16> bytes{};
    EXPECT_EQ(std::string(bytes.data(), far_.receive(bytes)), "stand");
  }
}

TEST_F(Line, NeverSendsWhatWaitedWhenAnOrderCame) {
  Core core(far_.device());
  Core brake(far_.device());
  std::size_t sent = 0;
  std::size_t refused = 0;
  ASSERT_TRUE(eventually([&] {  // the terminal is full, and so is the ring
    const bool accepted = core.line.send(std::string(20, 'g'));
    sent += accepted ? 20 : 0;
    refused = accepted ? 0 : refused + 1;
    return refused == 100;
  }));

  brake.line.overrule("halt");
  ASSERT_TRUE(brake.line.send("halt"));

  std::string all;
  const auto hears = [&](std::string_view text) {
    return eventually([&] {
      std::array<char, 512> some{};
      all.append(some.data(), far_.receive(some));
      return all.find(text) != std::string::npos;
    });
  };
  ASSERT_TRUE(hears("halt"));
  ASSERT_TRUE(eventually([&] { return core.line.send("on"); }));
  ASSERT_TRUE(hears("on")) << "what is sent later counts again";
  EXPECT_EQ(all.find('g', all.rfind("halt")), std::string::npos);
  EXPECT_LT(all.size(), sent) << "one had begun, one waited behind it";
}

/// Writes only when it may.
class Gated final : public mauve::serial::LineEnd {
 public:
  Gated() : bell_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  [[nodiscard]] int number() const override { return bell_.number(); }
  std::ptrdiff_t read(std::span<char>) override { return 0; }
  std::ptrdiff_t write(std::string_view bytes) const override {
    under_way = true;
    EXPECT_TRUE(eventually([this] { return may.load(); }));
    const std::lock_guard lock(mutex_);
    written_ += bytes;
    return static_cast<std::ptrdiff_t>(bytes.size());
  }
  void close() override {}
  bool reopen() override { return true; }
  [[nodiscard]] std::uint8_t times_overruled() const override { return overruled; }
  void repeat_order() override { ++repeats; }
  [[nodiscard]] std::string name() const override { return "gated"; }
  [[nodiscard]] std::string written() const {
    const std::lock_guard lock(mutex_);
    return written_;
  }

  mutable std::atomic<bool> under_way{false};
  std::atomic<bool> may{false};
  std::atomic<std::uint8_t> overruled{0};
  std::atomic<int> repeats{0};

 private:
  mauve::serial::Descriptor bell_;
  mutable std::mutex mutex_;
  mutable std::string written_;
};

TEST_F(Line, SendsAnOrderAgainBehindWhatWasUnderWayWhenItCame) {
  Gated end;
  Gated other;
  LineThread driver;
  LineThread brake;
  ASSERT_TRUE(driver.start(end, 64));
  ASSERT_TRUE(brake.start(other, 64));
  ASSERT_TRUE(driver.send("go"));
  ASSERT_TRUE(eventually([&] { return end.under_way.load(); }));
  ASSERT_TRUE(driver.send("go on"));

  brake.overrule("halt");
  end.may = true;

  EXPECT_TRUE(eventually([&] { return end.written() == "gohalt"; })) << end.written();
  ASSERT_TRUE(driver.send("go again"));
  EXPECT_TRUE(eventually([&] { return end.written() == "gohaltgo again"; })) << end.written();
}

/// mauved sends the order of a guarded device itself. Its writer may get no processor meanwhile.
TEST_F(Line, SendsNothingFromBeforeASafeOrderThatFellDue) {
  Gated end;
  LineThread driver;
  ASSERT_TRUE(driver.start(end, 64));
  driver.overrule("halt");  // an order of another kind, which has gone out long ago
  ASSERT_TRUE(driver.send("go"));
  ASSERT_TRUE(eventually([&] { return end.under_way.load(); }));
  ASSERT_TRUE(driver.send("go on"));

  end.overruled = 1;
  end.may = true;

  EXPECT_TRUE(eventually([&] { return end.repeats == 1; })) << "it may have come before the end";
  ASSERT_TRUE(driver.send("go again"));
  EXPECT_TRUE(eventually([&] { return end.written() == "gogo again"; })) << end.written();
  EXPECT_EQ(end.repeats, 1);
}

/// A terminal whose reader waits for a worker of the kernel.
class Stuck final : public mauve::serial::LineEnd {
 public:
  [[nodiscard]] int number() const override { return always_.number(); }
  std::ptrdiff_t read(std::span<char>) override {
    reading = true;
    EXPECT_TRUE(eventually([this] { return written.load() > 0; })) << "the order waited";
    return 0;
  }
  std::ptrdiff_t write(std::string_view bytes) const override {
    written += bytes.size();
    return static_cast<std::ptrdiff_t>(bytes.size());
  }
  void close() override {}
  bool reopen() override { return true; }

  std::atomic<bool> reading{false};
  mutable std::atomic<std::size_t> written{0};

 private:
  mauve::serial::Descriptor always_{::eventfd(1, EFD_NONBLOCK | EFD_CLOEXEC)};  // never read dry
};

TEST_F(Line, SendsAnOrderWhileAReadOfItsDeviceWaits) {
  Stuck end;
  LineBytes bytes;
  LineThread driver;
  ASSERT_TRUE(driver.start(end, 64));
  driver.fill(bytes);
  ASSERT_TRUE(eventually([&] { return end.reading.load(); }));

  ASSERT_TRUE(driver.send("halt"));

  EXPECT_TRUE(eventually([&] { return end.written == 4; }));
  driver.stop();
}

std::size_t threads() {
  const fs::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(fs::begin(tasks), fs::end(tasks)));
}

TEST_F(Line, LeavesNoThreadBehind) {
  std::thread([] {}).join();  // with the first one a sanitizer makes a thread of its own
  const std::size_t before = threads();
  {
    LineBytes bytes;
    Core core(far_.device());
    core.line.fill(bytes);
    EXPECT_EQ(threads(), before + 2);
    core.line.stop();
    EXPECT_EQ(bytes.filler, 0U);
  }
  EXPECT_TRUE(eventually([&] { return threads() == before; }));
}

}  // namespace
}  // namespace mauve::test
