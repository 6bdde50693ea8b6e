// SPDX-License-Identifier: LGPL-3.0-or-later
#include "input_device.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <utility>

namespace teleop {

bool InputDevice::open() {
  drivers::Descriptor opened(::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat facts {};
  if (!opened.open() || ::fstat(opened.number(), &facts) != 0) return false;
  terminal_ = ::isatty(opened.number()) == 1;
  file_ = S_ISREG(facts.st_mode);
  device_ = std::move(opened);
  return true;
}

InputDevice::Got InputDevice::read(std::span<char> into, std::size_t& count) const {
  count = 0;
  const ssize_t got = ::read(device_.number(), into.data(), into.size());
  if (got > 0) {
    count = static_cast<std::size_t>(got);
    return Got::bytes;
  }
  if (got == 0) return terminal_ ? Got::lost : Got::nobody;
  return errno == EAGAIN || errno == EINTR ? Got::nothing : Got::lost;
}

bool InputDevice::ask(EventReader& reader) const {
  std::array<unsigned char, KEY_MAX / CHAR_BIT + 1> keys{};
  if (::ioctl(device_.number(), EVIOCGKEY(keys.size()), keys.data()) < 0) return false;
  reader.begin();
  for (std::uint16_t code = 0; code <= KEY_MAX; ++code) {
    if ((keys[code / CHAR_BIT] >> (code % CHAR_BIT) & 1) != 0) reader.set_key(code, true);
  }
  for (std::size_t axis = 0; axis < EventReader::kAxisCodes.size(); ++axis) {
    input_absinfo facts{};
    // An axis that the device does not have says nothing, or an empty range.
    if (::ioctl(device_.number(), EVIOCGABS(EventReader::kAxisCodes[axis]), &facts) < 0) continue;
    reader.set_range(axis, {facts.minimum, facts.maximum});
    reader.set_axis(axis, facts.value);
  }
  reader.show();
  return true;
}

}  // namespace teleop
