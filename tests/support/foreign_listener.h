// SPDX-License-Identifier: LGPL-3.0-or-later
/// A socket on which another user listens, without a process of that user.
#pragma once

#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <string>
#include <thread>

namespace mauve::test {

/// Needs the rights of root, which a test may lack: then listens() is false. Those who connect
/// are not answered.
class ForeignListener {
 public:
  static constexpr uid_t kUser = 4711;

  ForeignListener(const std::string& path, int type) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    // The rights of a thread alone: the C library would change those of all threads.
    std::thread([&] {
      if (syscall(SYS_setresuid, -1, kUser, -1) != 0) return;
      socket_ = ::socket(AF_UNIX, type | SOCK_CLOEXEC, 0);
      const auto* const place = reinterpret_cast<const sockaddr*>(&address);
      listens_ = bind(socket_, place, sizeof address) == 0 && listen(socket_, 4) == 0;
    }).join();
  }
  ~ForeignListener() { close(socket_); }
  ForeignListener(const ForeignListener&) = delete;
  ForeignListener& operator=(const ForeignListener&) = delete;

  [[nodiscard]] bool listens() const { return listens_; }

 private:
  int socket_ = -1;
  bool listens_ = false;
};

}  // namespace mauve::test
