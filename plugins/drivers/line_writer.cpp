// SPDX-License-Identifier: LGPL-3.0-or-later
#include "line_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace drivers {

bool LineWriter::open() {
  if (device_.open()) return true;
  Descriptor opened(::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!opened.open() || ::isatty(opened.number()) != 1) return false;
  device_ = std::move(opened);
  return true;
}

void LineWriter::close() {
  device_ = Descriptor();
  rest_size_ = 0;
}

bool LineWriter::send(std::string_view bytes) {
  if (bytes.size() > kLongest || !open() || !send_rest()) return false;
  std::ptrdiff_t count = write(bytes);
  // It may have gone and come back since.
  if (count < 0 && open()) count = write(bytes);
  if (count <= 0) return false;
  const std::string_view rest = bytes.substr(static_cast<std::size_t>(count));
  std::copy(rest.begin(), rest.end(), rest_.begin());
  rest_size_ = rest.size();
  return true;
}

/// Bytes that found room; -1 when the device failed, and it is closed.
std::ptrdiff_t LineWriter::write(std::string_view bytes) {
  const ssize_t count = ::write(device_.number(), bytes.data(), bytes.size());
  if (count >= 0) return count;
  if (errno == EAGAIN || errno == EINTR) return 0;
  close();
  return -1;
}

bool LineWriter::send_rest() {
  if (rest_size_ == 0) return true;
  const std::ptrdiff_t count = write({rest_.data(), rest_size_});
  if (count < 0) return open();  // a device that came anew has heard nothing
  std::copy(rest_.begin() + count, rest_.begin() + static_cast<std::ptrdiff_t>(rest_size_),
            rest_.begin());
  rest_size_ -= static_cast<std::size_t>(count);
  return rest_size_ == 0;
}

}  // namespace drivers
