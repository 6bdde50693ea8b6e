// SPDX-License-Identifier: LGPL-3.0-or-later
#include "say.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace mauve::guardian {

void say(const char* format, ...) {
  constexpr const char* kBegin = "mauve-guardian: ";
  std::array<char, 520> line{};
  const int begin = std::snprintf(line.data(), line.size(), "%s", kBegin);
  const auto from = static_cast<std::size_t>(begin);
  va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(line.data() + from, line.size() - from - 1, format, arguments);
  va_end(arguments);
  if (length < 0) return;
  const std::size_t end = std::min(from + static_cast<std::size_t>(length), line.size() - 2);
  for (std::size_t i = from; i < end; ++i) {  // a name forges no line
    if (static_cast<unsigned char>(line[i]) < 0x20 || line[i] == 0x7F) line[i] = '?';
  }
  line[end] = '\n';
  pollfd reader{STDERR_FILENO, POLLOUT, 0};
  if (poll(&reader, 1, 0) != 1 || reader.revents != POLLOUT) return;
  if (write(STDERR_FILENO, line.data(), end + 1) < 0) return;
}

}  // namespace mauve::guardian
