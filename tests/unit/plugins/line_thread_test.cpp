// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
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
  explicit Core(const std::string& device) {
    EXPECT_TRUE(port.open(device, 0, SerialPort::Missing::accepted, SerialPort::Use::both));
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
  LineThread::empty_handed(*bytes);
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
  LineThread::empty_handed(before);  // it has let go of them
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

}  // namespace
