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

}  // namespace
}  // namespace mauve::test
