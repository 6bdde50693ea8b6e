// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/standard_streams.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <initializer_list>

namespace mauve {

/// In this sequence the lowest free number is that of the closed stream. The access is the one that
/// the stream does not have, so that using it is an error.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    const int wrong_access = stream == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    if (open("/dev/null", wrong_access) >= 0) continue;  // NOLINT: it stays open
    if (socket(AF_UNIX, SOCK_STREAM, 0) < 0) return;     // NOLINT: it stays open
  }
}

}  // namespace mauve
