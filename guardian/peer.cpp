// SPDX-License-Identifier: LGPL-3.0-or-later
#include "peer.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace mauve::guardian {
namespace {

constexpr unsigned long kExiting = 0x4;  // PF_EXITING of the kernel, which proc(5) leaves to it

ucred credentials(int socket) {
  ucred who{};
  socklen_t size = sizeof who;
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) return {0, 0, 0};
  return who;
}

/// The ninth field of a line of /proc/PID/stat (proc(5)); the second may hold anything in brackets.
unsigned long flags_in(const char* line) {
  const char* at = std::strrchr(line, ')');
  if (at == nullptr) return 0;
  for (int field = 2; field < 9; ++field) {
    at = std::strchr(at + 1, ' ');
    if (at == nullptr) return 0;
  }
  return std::strtoul(at + 1, nullptr, 10);
}

}  // namespace

bool is_of_this_user(int socket) {
  const ucred who = credentials(socket);
  return who.pid != 0 && who.uid == geteuid();
}

Peer::~Peer() {
  if (handle_ >= 0) close(handle_);
  if (state_ >= 0) close(state_);
}

bool Peer::open(int socket, pid_t thread) {
  process_ = credentials(socket).pid;
  if (process_ == 0) return false;
  handle_ = static_cast<int>(syscall(SYS_pidfd_open, process_, 0));
  std::array<char, 64> path{};
  std::snprintf(path.data(), path.size(), "/proc/%d/task/%d/stat", process_, thread);
  state_ = ::open(path.data(), O_RDONLY | O_CLOEXEC);
  return handle_ >= 0 && state_ >= 0 && !gone();
}

bool Peer::gone() const {
  pollfd ended{handle_, POLLIN, 0};
  if (poll(&ended, 1, 0) > 0) return true;
  std::array<char, 512> line{};
  const ssize_t length = pread(state_, line.data(), line.size() - 1, 0);
  return length <= 0 || (flags_in(line.data()) & kExiting) != 0;
}

}  // namespace mauve::guardian
