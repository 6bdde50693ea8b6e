// SPDX-License-Identifier: LGPL-3.0-or-later
/// The content of a file that a property names.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <string>
#include <system_error>

#include <mauve/result.h>

namespace navigation {

/// Where a refused path begins.
inline constexpr const char* kWherePathsBegin =
    "a path is relative to the folder of the architecture, that of an image to the file that names "
    "it";

/// Reads a regular file of at most `most` bytes. The hook that calls this never waits. A FIFO, a
/// device and a socket are refused without a read, since the process at their other end would
/// decide when the hook returns. `what` names the file in errors: "map". [factory]
inline mauve::Result<std::string> read_regular_file(const std::string& path, std::size_t most,
                                                    const char* what) {
  using mauve::Errc;
  using mauve::refuse;
  const std::string named = std::string("the ") + what + " '" + path + "'";
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0) {
    return refuse(Errc::system, {},
                  "cannot open " + named + ": " + std::generic_category().message(errno),
                  kWherePathsBegin);
  }
  struct Close {
    int file;
    ~Close() { ::close(file); }
  } const close{file};
  struct stat facts {};
  if (::fstat(file, &facts) != 0 || !S_ISREG(facts.st_mode)) {
    return refuse(Errc::invalid_value, {}, "cannot open " + named + ": it is no regular file",
                  kWherePathsBegin);
  }
  const auto size = static_cast<std::size_t>(facts.st_size);
  if (size > most) {
    return refuse(Errc::limit, {}, path + ": has " + std::to_string(size) + " bytes",
                  std::string("a ") + what + " has at most " + std::to_string(most));
  }
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::read(file, bytes.data() + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      return refuse(Errc::system, {},
                    "cannot read " + named + ": " + std::generic_category().message(errno));
    }
    if (got == 0) break;  // it was cut meanwhile
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace navigation
