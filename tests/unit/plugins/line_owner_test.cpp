// SPDX-License-Identifier: LGPL-3.0-or-later
/// A device that another process has.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <string>
#include <utility>

#include "line_core.h"

namespace mauve::test {
namespace {

/// The other process holds the lock until the destructor.
class OtherProcess {
 public:
  explicit OtherProcess(const std::string& device) {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    process_ = ::fork();
    if (process_ == 0) {
      const int line = ::open(device.c_str(), O_RDWR | O_NOCTTY);
      const char done = ::flock(line, LOCK_EX | LOCK_NB) == 0 ? 'y' : 'n';
      static_cast<void>(::write(ends_[1], &done, 1));
      ::pause();
    }
    char done = 'n';
    EXPECT_EQ(::read(ends_[0], &done, 1), 1);
    EXPECT_EQ(done, 'y');
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;
  ~OtherProcess() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    for (const int end : ends_) ::close(end);
  }

 private:
  std::array<int, 2> ends_{};
  pid_t process_ = -1;
};

speed_t speed_of(const PseudoTerminal& far) {
  termios settings{};
  EXPECT_EQ(::tcgetattr(far.number(), &settings), 0);
  return ::cfgetospeed(&settings);
}

/// The driver of that process would send at a speed that its device does not have.
TEST_F(Line, LeavesTheSpeedOfADeviceThatAnotherProcessHolds) {
  const OtherProcess other(far_.device());
  const speed_t before = speed_of(far_);
  SerialPort port;
  EXPECT_FALSE(
      port.open(far_.device(), 4800, SerialPort::Missing::accepted, SerialPort::Use::both));
  const std::string link = link_name("held");
  ASSERT_TRUE(port.open(link, 4800, SerialPort::Missing::accepted, SerialPort::Use::both));
  fs::create_symlink(far_.device(), link);

  EXPECT_FALSE(port.reopen());

  EXPECT_EQ(errno, EBUSY);
  EXPECT_EQ(speed_of(far_), before);
  fs::remove(link);
}

/// Lines of two components, which know one device under two names. It is not there at first.
class OneDeviceOfTwo : public Line {
 protected:
  OneDeviceOfTwo() {
    left_.belongs_to("left.core");
    right_.belongs_to("right.core");
    for (auto [port, name] : {std::pair{&left_, "left"}, {&right_, "right"}}) {
      EXPECT_TRUE(
          port->open(link_name(name), 0, SerialPort::Missing::accepted, SerialPort::Use::both));
    }
  }
  ~OneDeviceOfTwo() override { unplug(); }

  void plug_in() {
    for (const char* name : {"left", "right"}) fs::create_symlink(far_.device(), link_name(name));
  }
  void unplug() {
    for (const char* name : {"left", "right"}) fs::remove(link_name(name));
  }
  /// A core that comes after the one with this line.
  [[nodiscard]] bool successor_opens(const char* component) {
    SerialPort next;
    next.belongs_to(std::string(component) + ".core");
    return next.open(link_name(component), 0, SerialPort::Missing::accepted,
                     SerialPort::Use::both) &&
           next.is_open();
  }

  SerialPort left_;
  SerialPort right_;
};

TEST_F(OneDeviceOfTwo, IsThatOfTheFirstUntilItLetsGo) {
  plug_in();

  ASSERT_TRUE(left_.reopen());
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(right_.reopen());
    EXPECT_EQ(errno, serial::kOfAnotherComponent);
  }

  left_.close();
  EXPECT_TRUE(right_.reopen());
  EXPECT_FALSE(left_.reopen());
  EXPECT_EQ(errno, serial::kOfAnotherComponent);
}

TEST_F(OneDeviceOfTwo, IsOfEachCoreOfItsComponentAndOfNoOtherThatWaits) {
  plug_in();
  ASSERT_TRUE(left_.reopen());
  ASSERT_FALSE(right_.reopen());

  EXPECT_TRUE(successor_opens("left"));
  EXPECT_FALSE(successor_opens("right"));
}

TEST_F(OneDeviceOfTwo, GoesOverToADriverThatTakesThePlaceOfTheOther) {
  plug_in();
  ASSERT_TRUE(left_.reopen());

  EXPECT_TRUE(successor_opens("right")) << "it has not waited";
}

/// The component of the left line has never run.
TEST_F(OneDeviceOfTwo, GoesToTheOtherOneWhenNoJobUsesIt) {
  plug_in();
  LineThread left;
  LineThread right;
  LineBytes of_right;
  ASSERT_TRUE(left.start(left_, 64, LineThread::Lost::looked_for));
  ASSERT_TRUE(eventually([&] { return left.open(); }));
  ASSERT_TRUE(right.start(right_, 64));

  EXPECT_TRUE(eventually([&] {
    right.fill(of_right);
    return right.reopen();
  }));

  EXPECT_FALSE(left.open());
  EXPECT_FALSE(eventually([&] { return left.reopen(); }, 300ms)) << "it comes second now";
  EXPECT_EQ(left.error(), serial::kOfAnotherComponent);
  left.stop();
  right.stop();
  right.empty_handed(of_right);
}

TEST_F(OneDeviceOfTwo, IsNotKeptByALineThatWaits) {
  plug_in();
  ASSERT_TRUE(left_.reopen());
  ASSERT_FALSE(right_.reopen());
  unplug();
  left_.close();

  EXPECT_FALSE(right_.reopen());

  EXPECT_EQ(errno, ENOENT);
  const OtherProcess other(far_.device());
}

}  // namespace
}  // namespace mauve::test
