// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <mauve/serial/serial_port.h>

#include "support/temp_dir.h"

namespace {

using mauve::serial::PseudoTerminal;
using mauve::serial::SerialPort;

namespace fs = std::filesystem;

std::string link_name(const char* name) {
  return (fs::path(testing::TempDir()) / (std::string("mauve_serial_") + name)).string();
}

std::string take(SerialPort& port) {
  std::array<char, 4096> bytes{};
  const auto count = port.read(bytes);
  return {bytes.data(), static_cast<std::size_t>(count > 0 ? count : 0)};
}

TEST(SerialPort, ReadsWhatWasSentUnchanged) {
  const std::string link = link_name("unchanged");
  PseudoTerminal line;
  SerialPort port;
  ASSERT_TRUE(line.open(link));
  ASSERT_TRUE(port.open(link, 9600));

  EXPECT_EQ(take(port), "");
  ASSERT_TRUE(line.send(std::string("\x03\x04\r\n$\xff\x11", 7)));

  EXPECT_EQ(take(port), std::string("\x03\x04\r\n$\xff\x11", 7));
  EXPECT_EQ(take(port), "");
}

TEST(SerialPort, NeverWaitsForBytes) {
  PseudoTerminal line;
  SerialPort port;
  ASSERT_TRUE(line.open(""));
  ASSERT_TRUE(port.open(line.device(), 0));
  std::array<char, 16> bytes{};

  EXPECT_EQ(port.read(bytes), 0);
}

/// Another process that has the device, until the test ends.
class OtherOwner {
 public:
  explicit OtherOwner(const std::string& device) {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    child_ = ::fork();
    if (child_ != 0) {
      ::close(ends_[1]);
      char said = 0;
      took_ = ::read(ends_[0], &said, 1) == 1 && said == 'y';
      return;
    }
    // An inherited lock would be its own.
    for (int number = 3; number < 256; ++number) {
      if (number != ends_[1]) ::close(number);
    }
    SerialPort port;
    const char said =
        port.open(device, 0, SerialPort::Missing::refused, SerialPort::Use::both) ? 'y' : 'n';
    if (::write(ends_[1], &said, 1) == 1) ::pause();
    ::_exit(0);
  }
  ~OtherOwner() {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    ::close(ends_[0]);
  }
  OtherOwner(const OtherOwner&) = delete;
  OtherOwner& operator=(const OtherOwner&) = delete;

  [[nodiscard]] bool took() const { return took_; }
  [[nodiscard]] pid_t process() const { return child_; }

 private:
  std::array<int, 2> ends_{-1, -1};
  pid_t child_ = -1;
  bool took_ = false;
};

TEST(SerialPort, RefusesADeviceOfAnotherProcessAndNamesIt) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  SerialPort port;
  {
    const OtherOwner other(line.device());
    ASSERT_TRUE(other.took());
    for (const auto use : {SerialPort::Use::both, SerialPort::Use::reading}) {
      const auto refused = port.open(line.device(), 0, SerialPort::Missing::accepted, use);
      ASSERT_FALSE(refused);
      EXPECT_NE(refused.error().message.find("process " + std::to_string(other.process())),
                std::string::npos)
          << refused.error().message;
    }
    EXPECT_FALSE(port.is_open());
    EXPECT_FALSE(port.reopen()) << "nor later, as long as it is there";
  }

  EXPECT_TRUE(port.open(line.device(), 0)) << "it ended";
}

TEST(SerialPort, KeepsItsDeviceFromOtherProcesses) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  SerialPort port;
  ASSERT_TRUE(port.open(line.device(), 0));
  EXPECT_FALSE(OtherOwner(line.device()).took());

  port.close();
  EXPECT_TRUE(OtherOwner(line.device()).took());
  EXPECT_TRUE(port.reopen());
  EXPECT_FALSE(OtherOwner(line.device()).took()) << "after an unplugged device came back";
}

TEST(SerialPort, LetsACoreTakeTheDeviceOverFromTheOneThatItReplaces) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  SerialPort old;
  ASSERT_TRUE(old.open(line.device(), 0));

  SerialPort next;
  ASSERT_TRUE(next.open(line.device(), 0));
  old.close();

  EXPECT_FALSE(OtherOwner(line.device()).took()) << "the new core still has it";
  next.close();
  EXPECT_TRUE(OtherOwner(line.device()).took());
}

/// The last way to stop a base does not ask who drives it.
TEST(SerialPort, OpensADeviceForAnEmergencyWhoeverHasIt) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  const OtherOwner other(line.device());
  ASSERT_TRUE(other.took());

  SerialPort brake;
  brake.choose(line.device(), 0, SerialPort::Use::both);
  EXPECT_TRUE(brake.reopen());
}

TEST(SerialPort, LocksNoFile) {
  const std::string path = link_name("file");
  std::ofstream(path) << "recorded";
  SerialPort one;
  SerialPort other;

  EXPECT_TRUE(one.open(path, 0));
  EXPECT_TRUE(other.open(path, 0));
  fs::remove(path);
}

TEST(SerialPort, NoticesThatItsDeviceIsGoneAndOpensItAgain) {
  const std::string link = link_name("again");
  PseudoTerminal line;
  SerialPort port;
  ASSERT_TRUE(line.open(link));
  ASSERT_TRUE(port.open(link, 9600));
  std::array<char, 16> bytes{};

  line.close();
  EXPECT_EQ(port.read(bytes), -1);
  port.close();
  EXPECT_FALSE(port.reopen());
  EXPECT_FALSE(port.is_open());

  ASSERT_TRUE(line.open(link));
  EXPECT_TRUE(port.reopen());
  ASSERT_TRUE(line.send("$GP"));
  EXPECT_EQ(take(port), "$GP");
}

TEST(SerialPort, FindsTheLineOfItsOwnProcessByName) {
  const std::string path = mauve::serial::line_path("pty:test");
  PseudoTerminal line;
  SerialPort port;

  ASSERT_TRUE(line.open("pty:test"));
  EXPECT_TRUE(fs::is_symlink(path)) << path;
  EXPECT_NE(path.find(std::to_string(getpid())), std::string::npos)
      << "two processes never collide";
  EXPECT_TRUE(port.open("pty:test", 9600));
  EXPECT_EQ(mauve::serial::line_path("/dev/ttyACM0"), "/dev/ttyACM0");
}

/// The rest of line_path("pty:test") after the number of the process.
std::string start_in(const std::string& path) { return path.substr(path.rfind('-')); }

TEST(SerialPort, NamesItsOwnLineAfterTheStartOfItsProcessSinceNumbersAreUsedAgain) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));  // a start is a tick of 10 ms

  const pid_t child = fork();
  if (child == 0) {
    const std::string path = mauve::serial::line_path("pty:test");
    _exit(::write(ends[1], path.data(), path.size()) > 0 ? 0 : 1);
  }
  std::array<char, 256> said{};
  const ssize_t length = ::read(ends[0], said.data(), said.size());
  waitpid(child, nullptr, 0);
  ::close(ends[0]);
  ::close(ends[1]);

  ASSERT_GT(length, 0);
  const std::string of_child(said.data(), static_cast<std::size_t>(length));
  EXPECT_NE(start_in(of_child), start_in(mauve::serial::line_path("pty:test")));
  EXPECT_EQ(mauve::serial::line_path("pty:test"), mauve::serial::line_path("pty:test"));
}

TEST(SerialPort, SaysWhyADeviceCannotBeOpened) {
  SerialPort port;
  const auto missing = port.open("/nowhere/ttyS9", 9600);
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  const auto slow = port.open(line.device(), 1234);

  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/nowhere/ttyS9"), std::string::npos);
  ASSERT_FALSE(slow);
  EXPECT_NE(slow.error().message.find("1234 baud"), std::string::npos);
  EXPECT_FALSE(port.is_open());
}

TEST(SerialPort, ReadsAPlainFileToo) {
  const std::string path = link_name("file");
  std::ofstream(path) << "$GPGGA";
  SerialPort port;

  ASSERT_TRUE(port.open(path, 9600));

  EXPECT_EQ(take(port), "$GPGGA");
  fs::remove(path);
}

TEST(SerialPort, IsNotWrittenToWhenItIsNoTerminal) {
  const std::string path = link_name("precious");
  std::ofstream(path) << "a recording";
  SerialPort port;

  const auto refused = port.open(path, 0, SerialPort::Missing::accepted, SerialPort::Use::both);
  port.choose(path, 0, SerialPort::Use::both);

  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("is no serial device"), std::string::npos);
  EXPECT_FALSE(port.reopen());
  EXPECT_EQ(fs::file_size(path), 11U);
  fs::remove(path);
}

TEST(PseudoTerminal, LosesWhatDoesNotFitInsteadOfWaiting) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  const std::string block(4096, 'x');
  bool all = true;

  for (int i = 0; i < 100; ++i) all = line.send(block) && all;

  EXPECT_FALSE(all);
}

TEST(PseudoTerminal, SaysThatAPathIsInUseByAnother) {
  const std::string link = link_name("in_use");
  const std::string device = link_name("of_another");
  std::ofstream(device) << "there, and not open in this process";
  fs::remove(link);
  fs::create_symlink(device, link);
  PseudoTerminal line;

  const auto refused = line.open(link);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, mauve::Errc::conflict);
  EXPECT_NE(refused.error().message.find("is in use"), std::string::npos);
  EXPECT_TRUE(fs::is_symlink(link));
  fs::remove(link);
  fs::remove(device);
}

/// As after `kill -9` of mauved, whose directory the service keeps.
TEST(PseudoTerminal, RemovesTheLinksOfProcessesThatAreNoMore) {
  const mauve::test::TempDir place;
  setenv("RUNTIME_DIRECTORY", place.path().c_str(), 1);
  const auto link = [&](const std::string& name) {
    fs::create_symlink("/dev/pts/none", place / name);
    return place / name;
  };
  const auto killed = link("mauve-gnss.999999999-1");
  const auto reused = link("mauve-gnss." + std::to_string(getppid()) + "-1");
  const auto no_line = link("mauve-gnss.of-mine");
  const auto other = link("gnss.999999999-1");
  PseudoTerminal line;
  ASSERT_TRUE(line.open("pty:gnss"));

  EXPECT_FALSE(fs::is_symlink(killed));
  EXPECT_FALSE(fs::is_symlink(reused)) << "another process had this number";
  EXPECT_TRUE(fs::is_symlink(no_line));
  EXPECT_TRUE(fs::is_symlink(other));

  PseudoTerminal second;
  ASSERT_TRUE(second.open("pty:imu"));
  EXPECT_TRUE(fs::is_symlink(mauve::serial::line_path("pty:gnss"))) << "this process lives";
  unsetenv("RUNTIME_DIRECTORY");
}

TEST(PseudoTerminal, ReplacesALinkThatLeadsNowhere) {
  const std::string link = link_name("stale");
  fs::remove(link);
  fs::create_symlink("/dev/pts/was_here", link);
  PseudoTerminal line;

  EXPECT_TRUE(line.open(link));
}

TEST(PseudoTerminal, ReplacesNoLinkOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: only root can give a link to another user";
  const std::string link = link_name("foreign");
  fs::remove(link);
  fs::create_symlink("/dev/pts/was_here", link);
  ASSERT_EQ(lchown(link.c_str(), 4711, 4711), 0);
  PseudoTerminal line;

  const auto opened = line.open(link);

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, mauve::Errc::conflict);
  EXPECT_EQ(fs::read_symlink(link), "/dev/pts/was_here");
  fs::remove(link);
}

TEST(PseudoTerminal, RemovesItsLinkAndNothingElse) {
  const std::string link = link_name("link");
  {
    PseudoTerminal line;
    ASSERT_TRUE(line.open(link));
    EXPECT_TRUE(fs::is_symlink(link));
    PseudoTerminal successor;
    ASSERT_TRUE(successor.open(link));
    line.close();
    EXPECT_TRUE(fs::is_symlink(link));
  }
  EXPECT_FALSE(fs::exists(fs::symlink_status(link)));

  std::ofstream(link) << "precious";
  PseudoTerminal line;
  EXPECT_FALSE(line.open(link));
  EXPECT_TRUE(fs::is_regular_file(link));
  fs::remove(link);
}

}  // namespace
