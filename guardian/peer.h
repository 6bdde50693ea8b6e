// SPDX-License-Identifier: LGPL-3.0-or-later
/// The process that a guardian watches, as the kernel reports it.
#pragma once

#include <sys/types.h>

namespace mauve::guardian {

/// One thread.
class Peer {
 public:
  Peer() = default;
  ~Peer();
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  /// The process at the other end of the socket, and one of its threads that lives as long as it
  /// does. False: it is gone already, or /proc does not show it.
  [[nodiscard]] bool open(int socket, pid_t thread);
  /// The process or the thread has ended or is ending. A process that is killed keeps its number
  /// for tens of milliseconds while its memory is freed; its threads are marked at once.
  [[nodiscard]] bool gone() const;
  [[nodiscard]] pid_t process() const { return process_; }
  /// Readable once the process has ended.
  [[nodiscard]] int handle() const { return handle_; }

 private:
  pid_t process_ = 0;
  int handle_ = -1;  // a pidfd
  int state_ = -1;   // /proc/PROCESS/task/THREAD/stat
};

/// The user at the other end of a socket is that of this process.
[[nodiscard]] bool is_of_this_user(int socket);

}  // namespace mauve::guardian
