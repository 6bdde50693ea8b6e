// SPDX-License-Identifier: LGPL-3.0-or-later
/// The devices of lines: lost, found again, and shared with other lines.
#include <fcntl.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <termios.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <fstream>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <mauve/detail/job.h>
#include <mauve/plugin.h>
#include <mauve/serial/device_line.h>
#include <mauve/test_kit.h>

#include "line_core.h"

namespace mauve::test {
namespace {

TEST_F(Line, TheCoreThatRanLastIsTheOnlyOneThatReads) {
  // Each with bytes of its own: what was before them is dropped, lost, or restarted.
  LineBytes of_first;  // The line fills them until its core is gone.
  LineBytes of_second;
  Core first(far_.device());
  Core second(far_.device());
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
  const mauve::serial::Descriptor opened(::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
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

TEST(LineLost, IsReportedAndOpenedAgainOnRequest) {
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

/// Its order must reach it, whether jobs run or not.
TEST(LineLost, IsLookedForWithoutAnyJobWhereThatIsWanted) {
  const std::string link = link_name("looked_for");
  SerialPort port;
  ASSERT_TRUE(port.open(link, 0, SerialPort::Missing::accepted, SerialPort::Use::both));
  LineThread line;
  ASSERT_TRUE(line.start(port, 64, LineThread::Lost::looked_for));
  for (unsigned loss = 1; loss <= 3; ++loss) {
    PseudoTerminal far;
    ASSERT_TRUE(far.open(link));
    EXPECT_TRUE(eventually([&] { return line.open(); }));
    far.close();
    EXPECT_TRUE(eventually([&] { return line.losses() == loss; }));
  }
  line.stop();
}

/// A device that fails in the middle of the first request, and comes back.
class HalfHearing final : public mauve::serial::LineEnd {
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
  mauve::serial::Descriptor always_{::eventfd(0, EFD_CLOEXEC)};
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

/// A device that fails for writers while a read of it brings its last bytes.
class LastBytes final : public mauve::serial::LineEnd {
 public:
  [[nodiscard]] int number() const override { return open_ ? always_.number() : -1; }
  [[nodiscard]] std::ptrdiff_t read(std::span<char> into) override {
    if (std::exchange(read_, true)) return 0;
    reading = true;
    EXPECT_TRUE(eventually([this] { return failed_.load(); }));
    const std::string_view words = "last words";
    return static_cast<std::ptrdiff_t>(words.copy(into.data(), into.size()));
  }
  [[nodiscard]] std::ptrdiff_t write(std::string_view) const override {
    failed_ = true;
    errno = EIO;
    return -1;
  }
  void close() override { open_ = false; }
  bool reopen() override { return open_ = true; }

  std::atomic<bool> reading{false};

 private:
  mauve::serial::Descriptor always_{::eventfd(1, EFD_CLOEXEC)};
  mutable std::atomic<bool> failed_{false};
  bool read_ = false;
  bool open_ = true;
};

TEST(LineLost, HasHandedOverItsLastBytesAlsoWhenAWriteMeetsTheLoss) {
  LastBytes device;
  LineBytes bytes;
  LineThread line;
  ASSERT_TRUE(line.start(device, 64));
  line.fill(bytes);
  ASSERT_TRUE(eventually([&] { return device.reading.load(); }));
  ASSERT_TRUE(line.send("go"));

  ASSERT_TRUE(eventually([&] { return !line.open(); }));
  EXPECT_EQ(bytes.ring.size(), 10U) << "they are no bytes of the next device";
  EXPECT_EQ(line.losses(), 1U);
  EXPECT_EQ(line.error(), EIO);
  line.stop();
}

TEST_F(Line, SendsNothingForAJobWhoseThreadIsAbandoned) {
  Core core(far_.device());
  mauve::this_job().running = true;
  mauve::this_job().no_ports = true;
  EXPECT_FALSE(core.line.send("drive on"));
  mauve::this_job().running = false;
  EXPECT_TRUE(core.line.send("begin")) << "a hook of a core that is prepared";
  mauve::this_job().no_ports = false;
  core.line.stop();
  EXPECT_EQ(heard(far_, 5), "begin");
}

TEST(LineLost, TakesNothingBeforeItIsStarted) {
  LineBytes bytes;
  LineThread line;
  line.fill(bytes);
  EXPECT_FALSE(line.send("go"));
  EXPECT_FALSE(line.open());
}

/// How the threads of lines in this process are scheduled.
std::multiset<int> policies_of_lines() {
  std::multiset<int> policies;
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    if (!name.starts_with("mauve-line")) continue;
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
    return policies_of_lines() == std::multiset<int>{SCHED_OTHER, SCHED_OTHER, SCHED_FIFO};
  }));
  brake.stop();
}

struct Wheels final : mauve::Core<mauve::EmptyShell> {
  void update() {}
  Status on_configure() override { return line.open(); }
  void on_cleanup() override { line.close(bytes); }
  /// In a job of its own, which takes all that came.
  bool is_lost() {
    char byte = 0;
    while (line.take(bytes, byte)) {
    }
    return line.lost() && !line.reopen();
  }
  LineBytes bytes;
  mauve::serial::DeviceLine line{*this, {}};
};

class DeviceOfACore : public testing::Test {
 protected:
  void begin(const std::string& device) {
    bench_.core().line.device = device;
    ASSERT_TRUE(bench_.configure());
    bench_.advance(1s);
  }
  /// A job later.
  bool lost() {
    bench_.advance(1ms);
    return bench_.core().is_lost();
  }
  PseudoTerminal far_;
  CoreBench<mauve::EmptyShell, Wheels> bench_;
  mauve::serial::DeviceLine& line_ = bench_.core().line;
};

TEST_F(DeviceOfACore, WarnsAsLongAsItIsNotThere) {
  const std::string link = link_name("warns");
  begin(link);
  EXPECT_TRUE(lost());
  EXPECT_TRUE(line_.unplugged.lasts());
  ASSERT_TRUE(far_.open(link));
  EXPECT_TRUE(eventually([&] { return !lost(); }));
  EXPECT_FALSE(line_.unplugged.lasts());

  far_.close();

  EXPECT_TRUE(eventually([&] { return lost(); }));
  EXPECT_TRUE(line_.unplugged.lasts());
  EXPECT_FALSE(line_.takes_no_bytes.lasts());
}

TEST_F(DeviceOfACore, WarnsAsLongAsItTakesNoCommand) {
  ASSERT_TRUE(far_.open(""));
  begin(far_.device());
  const std::string command(200, 'x');
  EXPECT_TRUE(line_.send(command));
  EXPECT_FALSE(line_.takes_no_bytes.lasts());

  EXPECT_TRUE(eventually([&] { return !line_.send(command); })) << "nobody reads at the far end";

  EXPECT_TRUE(line_.takes_no_bytes.lasts());
  EXPECT_EQ(line_.unsent, 1U);
  EXPECT_TRUE(eventually([&] {
    std::array<char, 512> some{};
    while (far_.receive(some) > 0) {
    }
    return line_.send("x");
  }));
  EXPECT_FALSE(line_.takes_no_bytes.lasts());
}

}  // namespace
}  // namespace mauve::test
