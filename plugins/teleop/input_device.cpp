// SPDX-License-Identifier: LGPL-3.0-or-later
#include "input_device.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstring>
#include <utility>

namespace teleop {

void InputDevice::choose(const std::string& path, std::chrono::nanoseconds retry) {
  close();
  path_ = path;
  retry_ = retry;
}

bool InputDevice::reopen() {
  opened_ = std::chrono::steady_clock::now();
  mauve::serial::Descriptor opened(
      ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat facts {};
  if (!opened.open() || ::fstat(opened.number(), &facts) != 0) return false;
  terminal_ = ::isatty(opened.number()) == 1;
  file_ = S_ISREG(facts.st_mode);
  there_ = dropping_ = false;
  part_size_ = 0;
  device_ = std::move(opened);
  return true;
}

std::ptrdiff_t InputDevice::read(std::span<char> into) {
  if (handed_ == said_size_ * sizeof(input_event)) {
    handed_ = said_size_ = 0;
    if (!fetch()) return -1;
  }
  const std::size_t left = said_size_ * sizeof(input_event) - handed_;
  const std::size_t count = std::min(left, into.size());
  std::memcpy(into.data(), reinterpret_cast<const char*>(said_.data()) + handed_, count);
  handed_ += count;
  return static_cast<std::ptrdiff_t>(count);
}

std::ptrdiff_t InputDevice::write(std::string_view) const {
  errno = EBADF;
  return -1;
}

/// False: the device failed, hung up, or its path leads nowhere any more.
bool InputDevice::fetch() {
  std::array<char, kAtOnce * sizeof(input_event)> bytes{};
  const ssize_t got = ::read(device_.number(), bytes.data(), bytes.size());
  if (got == 0) return !terminal_ && nobody();
  if (got < 0 && errno != EAGAIN && errno != EINTR) return false;
  if (!there_) appear();
  if (got > 0) take({bytes.data(), static_cast<std::size_t>(got)});
  return true;
}

void InputDevice::take(std::span<const char> bytes) {
  bool asking = false;
  for (const char byte : bytes) {
    part_[part_size_++] = byte;
    if (part_size_ < part_.size()) continue;
    part_size_ = 0;
    input_event event;
    std::memcpy(&event, part_.data(), sizeof event);
    if (event.type == Mark::kType) continue;
    said_[said_size_++] = event;
    if (event.type != EV_SYN) continue;
    if (event.code == SYN_DROPPED) dropping_ = true;
    if (event.code == SYN_REPORT) asking = std::exchange(dropping_, false) || asking;
  }
  if (asking) ask();
}

/// A FIFO may have been made anew under its name.
bool InputDevice::nobody() {
  if (std::exchange(there_, false)) say(Mark::kType, Mark::kGone, 0);
  part_size_ = 0;
  return file_ || std::chrono::steady_clock::now() - opened_ < retry_ || reopen();
}

void InputDevice::appear() {
  there_ = true;
  say(Mark::kType, Mark::kThere, 0);
  ask();
}

/// Ranges and state of a real input device; anything else does not answer.
void InputDevice::ask() {
  std::array<unsigned char, KEY_MAX / CHAR_BIT + 1> keys{};
  if (::ioctl(device_.number(), EVIOCGKEY(keys.size()), keys.data()) < 0) return;
  for (std::size_t axis = 0; axis < EventReader::kAxisCodes.size(); ++axis) {
    input_absinfo facts{};
    // An axis that the device does not have gives an error, or an empty range.
    if (::ioctl(device_.number(), EVIOCGABS(EventReader::kAxisCodes[axis]), &facts) < 0) continue;
    const auto at = static_cast<std::uint16_t>(axis);
    say(Mark::kType, Mark::kLowest + at, facts.minimum);
    say(Mark::kType, Mark::kHighest + at, facts.maximum);
    say(EV_ABS, EventReader::kAxisCodes[axis], facts.value);
  }
  for (std::uint16_t code = BTN_MISC; code <= KEY_MAX; ++code) {
    const bool held = (keys[code / CHAR_BIT] >> (code % CHAR_BIT) & 1) != 0;
    if (held && EventReader::knows_key(code)) say(EV_KEY, code, 1);
  }
  say(EV_SYN, SYN_REPORT, 0);
}

void InputDevice::say(std::uint16_t type, std::uint16_t code, std::int32_t value) {
  input_event event{};
  event.type = type;
  event.code = code;
  event.value = value;
  said_[said_size_++] = event;
}

}  // namespace teleop
