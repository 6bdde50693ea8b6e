// SPDX-License-Identifier: LGPL-3.0-or-later
#include "serial_port.h"

#include <fcntl.h>
#include <stdlib.h>  // NOLINT: posix_openpt and its family
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace drivers {
namespace {

using mauve::Errc;
using mauve::refuse;
using mauve::Status;

std::string system_text(int number) { return std::generic_category().message(number); }

speed_t speed_of(int baud) {
  constexpr std::array<std::pair<int, speed_t>, 9> kSpeeds{{{4800, B4800},
                                                            {9600, B9600},
                                                            {19200, B19200},
                                                            {38400, B38400},
                                                            {57600, B57600},
                                                            {115200, B115200},
                                                            {230400, B230400},
                                                            {460800, B460800},
                                                            {921600, B921600}}};
  for (const auto& [number, speed] : kSpeeds) {
    if (number == baud) return speed;
  }
  return B0;
}

Status make_raw(int descriptor, int baud) {
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) return mauve::ok();  // not a terminal
  cfmakeraw(&settings);
  settings.c_cflag |= static_cast<tcflag_t>(CLOCAL | CREAD);
  if (baud != 0) {
    const speed_t speed = speed_of(baud);
    if (speed == B0) {
      return refuse(Errc::invalid_value, {}, "no such speed: " + std::to_string(baud) + " baud",
                    "common ones are 9600, 38400 and 115200; 0 leaves it alone");
    }
    cfsetispeed(&settings, speed);
    cfsetospeed(&settings, speed);
  }
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0) {
    return refuse(Errc::system, {}, "cannot set the line to raw mode: " + system_text(errno));
  }
  return mauve::ok();
}

Status replace_link(const std::string& target, const std::string& link) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::file_status there = fs::symlink_status(link, problem);
  if (fs::exists(there) && !fs::is_symlink(there)) {
    return refuse(Errc::conflict, {}, "'" + link + "' is there and is not a symbolic link",
                  "choose another path");
  }
  problem.clear();
  fs::remove(link, problem);
  fs::create_symlink(target, link, problem);
  if (problem) {
    return refuse(Errc::system, {}, "cannot create the link '" + link + "': " + problem.message());
  }
  return mauve::ok();
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Status SerialPort::open(const std::string& device, int baud) {
  Descriptor opened(::open(device.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!opened.open()) {
    return refuse(Errc::system, {}, "cannot open '" + device + "': " + system_text(errno),
                  errno == EACCES ? "the user of mauved needs the group 'dialout'"
                                  : "is the receiver plugged in, and the path right?");
  }
  if (Status raw = make_raw(opened.number(), baud); !raw) return raw;
  device_ = std::move(opened);
  return mauve::ok();
}

std::ptrdiff_t SerialPort::read(std::span<char> into) const {
  const ssize_t count = ::read(device_.number(), into.data(), into.size());
  if (count >= 0) return count;
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

Status PseudoTerminal::open(const std::string& link) {
  Descriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> path{};
  if (!master.open() || grantpt(master.number()) != 0 || unlockpt(master.number()) != 0 ||
      ptsname_r(master.number(), path.data(), path.size()) != 0) {
    return refuse(Errc::system, {}, "cannot create a pseudo-terminal: " + system_text(errno));
  }
  Descriptor slave(::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!slave.open()) {
    return refuse(Errc::system, {},
                  "cannot open '" + std::string(path.data()) + "': " + system_text(errno));
  }
  if (Status raw = make_raw(slave.number(), 0); !raw) return raw;
  if (!link.empty()) {
    if (Status linked = replace_link(path.data(), link); !linked) return linked;
  }
  close();
  master_ = std::move(master);
  slave_ = std::move(slave);
  path_ = path.data();
  link_ = link;
  return mauve::ok();
}

void PseudoTerminal::close() {
  std::error_code ignored;
  // Only our own link: a successor may have put its own there meanwhile.
  if (!link_.empty() && std::filesystem::read_symlink(link_, ignored) == path_) {
    std::filesystem::remove(link_, ignored);
  }
  link_.clear();
  path_.clear();
  master_ = Descriptor();
  slave_ = Descriptor();
}

std::size_t PseudoTerminal::send_some(std::string_view bytes) const {
  const ssize_t count = ::write(master_.number(), bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace drivers
