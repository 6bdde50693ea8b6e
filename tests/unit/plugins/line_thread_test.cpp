// SPDX-License-Identifier: LGPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <termios.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "../../../plugins/drivers/line_thread.h"
#include "support/eventually.h"

namespace {

using drivers::LineBytes;
using drivers::LineThread;
using drivers::PseudoTerminal;
using drivers::SerialPort;
using mauve::test::eventually;

namespace fs = std::filesystem;

std::string link_name(const char* name) {
  return (fs::path(testing::TempDir()) / (std::string("mauve_line_") + name)).string();
}

/// A core's side: a line, and what a job does with it.
struct Core {
  explicit Core(const std::string& device, int baud = 0) {
    EXPECT_TRUE(port.open(device, baud, SerialPort::Missing::accepted, SerialPort::Use::both));
    EXPECT_TRUE(line.start(port, 64));
  }
  ~Core() { line.stop(); }

  /// All that is there now, in a job with these bytes.
  std::string job(LineBytes& bytes) {
    line.fill(bytes);
    std::string all;
    for (auto there = bytes.ring.there(); !there.empty(); there = bytes.ring.there()) {
      all.append(there.begin(), there.end());
      bytes.ring.drop(there.size());
    }
    return all;
  }
  /// Jobs until this much came.
  std::string jobs(LineBytes& bytes, std::size_t size) {
    std::string all;
    EXPECT_TRUE(eventually([&] { return (all += job(bytes)).size() >= size; })) << all.size();
    return all;
  }

  SerialPort port;
  LineThread line;
};

/// What the far end hears until it is as long as that.
std::string heard(const PseudoTerminal& far, std::size_t size) {
  std::string all;
  EXPECT_TRUE(eventually([&] {
    std::array<char, 512> some{};
    all.append(some.data(), far.receive(some));
    return all.size() >= size;
  })) << all.size();
  return all;
}

std::string numbered(std::size_t size) {
  std::string text;
  for (int i = 0; text.size() < size; ++i) text += std::to_string(i) + " ";
  return text.substr(0, size);
}

class Line : public testing::Test {
 protected:
  Line() { EXPECT_TRUE(far_.open("")); }
  PseudoTerminal far_;
};

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
    const bool taken = core.line.send(request);
    sent += taken ? 1 : 0;
    refused = taken ? 0 : refused + 1;
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
  second->line.stop();
  first->line.empty_handed(*bytes);
  bytes.reset();
}

TEST_F(Line, TheCoreThatRanLastIsTheOnlyOneThatReads) {
  // Each with bytes of its own: what was before them is dropped, lost, or restarted.
  Core first(far_.device());
  Core second(far_.device());
  LineBytes of_first;
  LineBytes of_second;
  for (int change = 0; change < 50; ++change) {
    Core& core = change % 2 == 0 ? first : second;
    LineBytes& bytes = change % 2 == 0 ? of_first : of_second;
    EXPECT_EQ(core.job(bytes), "") << change;
    const std::string text = "number " + std::to_string(1000 + change);
    ASSERT_TRUE(far_.send(text));
    ASSERT_EQ(core.jobs(bytes, text.size()), text) << change;
  }
}

speed_t speed_of(const std::string& device) {
  const drivers::Descriptor opened(::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  EXPECT_EQ(tcgetattr(opened.number(), &settings), 0);
  return cfgetospeed(&settings);
}

TEST_F(Line, HasTheSpeedOfTheCoreThatRanLast) {
  LineBytes bytes;
  Core first(far_.device(), 9600);
  ASSERT_TRUE(far_.send("one"));
  EXPECT_EQ(first.jobs(bytes, 3), "one");
  EXPECT_EQ(speed_of(far_.device()), B9600);
  {
    Core refused(far_.device(), 115'200);
    EXPECT_EQ(speed_of(far_.device()), B9600) << "it never ran";
  }
  Core second(far_.device(), 57'600);
  EXPECT_EQ(first.job(bytes), "");
  EXPECT_EQ(speed_of(far_.device()), B9600);

  const auto becomes = [&](Core& core, speed_t speed) {
    return eventually([&] { return core.job(bytes).empty() && speed_of(far_.device()) == speed; });
  };
  EXPECT_TRUE(becomes(second, B57600));
  EXPECT_TRUE(becomes(first, B9600)) << "and back";
  first.line.stop();
  second.line.stop();
  first.line.empty_handed(bytes);
}

TEST_F(Line, ReadsAlthoughAJobWasThrownOutWhileItSaidWhatToFill) {
  Core core(far_.device());
  LineBytes bytes;
  bytes.home = reinterpret_cast<std::uintptr_t>(&bytes);
  bytes.wanted = bytes.filler = reinterpret_cast<std::uintptr_t>(&core.line);
  ASSERT_TRUE(far_.send("heard"));

  EXPECT_EQ(core.jobs(bytes, 5), "heard");
  core.line.stop();
  bytes.filler = reinterpret_cast<std::uintptr_t>(&core.line);
  core.line.empty_handed(bytes);
  EXPECT_EQ(bytes.filler, 0U);
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

TEST(LineLost, IsToldAndOpenedAgainWhenAskedTo) {
  const std::string link = link_name("again");
  LineBytes bytes;
  Core core(link);
  EXPECT_FALSE(core.line.open());
  EXPECT_FALSE(core.line.reopen());
  PseudoTerminal far;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(far.open(link));
    ASSERT_TRUE(eventually([&] { return core.line.reopen(); }));
    ASSERT_TRUE(far.send("here"));
    EXPECT_EQ(core.jobs(bytes, 4), "here");
    far.close();
    EXPECT_TRUE(eventually([&] { return !core.line.open(); })) << "it hung up";
    EXPECT_TRUE(eventually([&] { return !core.line.reopen() && core.line.error() != 0; }));
  }
}

TEST(LineLost, BringsWhatCameBeforeItWent) {
  const std::string link = link_name("went");
  PseudoTerminal far;
  ASSERT_TRUE(far.open(link));
  LineBytes bytes;
  Core core(link);
  core.line.fill(bytes);
  ASSERT_TRUE(far.send("last words"));
  ASSERT_TRUE(eventually([&] { return bytes.ring.size() == 10; }));
  far.close();
  ASSERT_TRUE(eventually([&] { return !core.line.open(); }));

  EXPECT_EQ(core.job(bytes), "last words");
}

TEST(LineLost, IsOpenedWhenSomethingIsSentWhereThatIsWanted) {
  const std::string link = link_name("brake");
  SerialPort port;
  port.choose(link, 0, SerialPort::Use::both);
  LineThread line;
  std::atomic<int> unsent{0};
  line.when_unsent([&] { ++unsent; });
  ASSERT_TRUE(line.start(port, 64, LineThread::Lost::opened_to_send));

  EXPECT_TRUE(line.send("early"));
  EXPECT_TRUE(eventually([&] { return unsent == 1; }));
  for (int i = 0; i < 3; ++i) {
    PseudoTerminal far;
    ASSERT_TRUE(far.open(link));
    EXPECT_TRUE(line.send("stand"));
    EXPECT_EQ(heard(far, 5), "stand") << "also when it came anew";
  }
  EXPECT_EQ(unsent, 1);
  line.stop();
}

/// A device that fails in the middle of the first request, and comes back.
class HalfHearing final : public drivers::LineEnd {
 public:
  [[nodiscard]] int number() const override { return open_ ? always_.number() : -1; }
  [[nodiscard]] std::ptrdiff_t read(std::span<char>) override { return 0; }
  [[nodiscard]] std::ptrdiff_t write(std::string_view bytes) const override {
    if (failing_ && !heard_.empty()) return -1;
    const std::string_view some = bytes.substr(0, failing_ ? 2 : bytes.size());
    heard_ += some;
    return static_cast<std::ptrdiff_t>(some.size());
  }
  void close() override { open_ = false; }
  bool reopen() override {
    failing_ = false;
    heard_.clear();
    return open_ = true;
  }
  [[nodiscard]] const std::string& heard() const { return heard_; }

 private:
  drivers::Descriptor always_{::eventfd(0, EFD_CLOEXEC)};
  mutable std::string heard_;
  bool failing_ = true;
  bool open_ = true;
};

TEST(LineLost, NeverGoesOnInTheMiddleOfARequest) {
  for (const auto lost : {LineThread::Lost::opened_to_send, LineThread::Lost::waits}) {
    HalfHearing device;
    LineThread line;
    ASSERT_TRUE(line.start(device, 64, lost));
    ASSERT_TRUE(line.send("stand!"));
    if (lost == LineThread::Lost::waits) {
      ASSERT_TRUE(eventually([&] { return !line.open(); }));
      ASSERT_TRUE(eventually([&] { return line.reopen(); }));
      ASSERT_TRUE(line.send("anew!!"));
    }
    line.stop();  // all is sent by then
    EXPECT_EQ(device.heard(), lost == LineThread::Lost::waits ? "anew!!" : "stand!");
  }
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
    EXPECT_EQ(threads(), before + 1);
    core.line.stop();
    EXPECT_EQ(bytes.filler, 0U);
  }
  EXPECT_TRUE(eventually([&] { return threads() == before; }));
}

/// How the threads of lines in this process are scheduled.
std::multiset<int> policies_of_lines() {
  std::multiset<int> policies;
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    if (name != "mauve-line") continue;
    policies.insert(sched_getscheduler(std::stoi(task.path().filename())));
  }
  return policies;
}

TEST_F(Line, OpenedToSendIsARealTimeThreadBeforeItsFirstRequest) {
  const sched_param lowest{sched_get_priority_min(SCHED_FIFO)};
  if (sched_setscheduler(0, SCHED_FIFO, &lowest) != 0) {
    GTEST_SKIP() << "SKIPPED: no right to real-time priorities";
  }
  const sched_param none{0};
  ASSERT_EQ(sched_setscheduler(0, SCHED_OTHER, &none), 0);
  SerialPort port;
  port.choose(far_.device(), 0, SerialPort::Use::both);
  Core ordinary(far_.device());
  LineThread brake;
  ASSERT_TRUE(brake.start(port, 64, LineThread::Lost::opened_to_send));

  EXPECT_TRUE(eventually([] {
    return policies_of_lines() == std::multiset<int>{SCHED_OTHER, SCHED_FIFO};
  }));
  brake.stop();
}

}  // namespace
