// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauve-guardian: puts outputs into their safe state when mauved cannot any more (README.md).
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "base/standard_streams.h"
#include "sandbox.h"
#include "say.h"
#include "session.h"

namespace {

using mauve::guardian::say;
using mauve::guardian::Session;

constexpr int kWrongUse = 2;
constexpr const char* kHelp =
    "Usage: mauve-guardian --socket PATH     serves one mauved after another on this socket\n"
    "       mauve-guardian --connected FD    serves the mauved at the other end of a descriptor\n"
    "Holds a descriptor and some bytes for each output, and sends them when mauved ends without\n"
    "having said so, or falls silent. mauved --guardian looks for it beside its own socket, at\n"
    "PATH.guardian, and starts one when there is none.\n";

int refuse_use(const char* text) {
  std::fprintf(stderr, "error: %s\nhint: mauve-guardian --help\n", text);
  return kWrongUse;
}

int print_help() {
  if (std::fputs(kHelp, stdout) >= 0 && std::fflush(stdout) == 0) return 0;
  std::fprintf(stderr, "error: the help cannot be written: %s\n", std::strerror(errno));
  return 1;
}

/// Reports the error and returns -1.
int failed(const char* doing, const char* path) {
  say("cannot %s %s: %s.", doing, path, std::strerror(errno));
  return -1;
}

/// Replaces the socket of a guardian that is gone: only there nobody listens. False: the place is
/// taken, and errno says why.
bool is_free(const sockaddr_un& address) {
  struct stat there {};
  if (lstat(address.sun_path, &there) != 0) return errno == ENOENT;
  if (!S_ISSOCK(there.st_mode)) {
    errno = EEXIST;
    return false;
  }
  const int socket = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return false;
  const int failed = connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int why = failed == 0 || errno == EAGAIN ? EADDRINUSE : errno;
  close(socket);
  errno = why;
  return why == ECONNREFUSED && unlink(address.sun_path) == 0;
}

/// The socket that a mauved connects to; -1: there is none, and the error is reported.
int listen_at(const char* path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (std::strlen(path) >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return failed("listen at", path);
  }
  std::strcpy(address.sun_path, path);
  if (!is_free(address)) return failed("listen at", path);
  const int socket = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  umask(0177);
  if (bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(socket, 4) != 0) {
    close(socket);
    return failed("listen at", path);
  }
  return socket;
}

/// Notifies the service manager, where there is one, that mauved may connect (sd_notify(3)).
void report_ready() {
  const char* const place = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (place == nullptr || std::strlen(place) >= sizeof address.sun_path) return;
  std::strcpy(address.sun_path, place);
  if (*place == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(place));
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  constexpr std::string_view kReady = "READY=1";
  if (sendto(socket, kReady.data(), kReady.size(), MSG_NOSIGNAL,
             reinterpret_cast<const sockaddr*>(&address), size) < 0) {
    say("the service manager does not hear that it is ready: %s.", std::strerror(errno));
  }
  close(socket);
}

/// One mauved after another, for ever. A mauved that comes meanwhile waits for its turn.
void serve_all(int listener) {
  for (;;) {
    const int socket = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) {
      pollfd next{listener, POLLIN, 0};
      poll(&next, 1, 1000);  // out of descriptors: some may be closed
      continue;
    }
    if (!mauve::guardian::is_of_this_user(socket)) {
      say("turned away a process of another user.");
      close(socket);
      continue;
    }
    Session(socket).run();
  }
}

}  // namespace

int main(int count, char** words) {
  mauve::occupy_standard_streams();  // else its text could go to the device of an output
  std::signal(SIGPIPE, SIG_IGN);     // of an output, or of the log, whose reader is gone
  const std::string_view option = count > 1 ? words[1] : "";
  if (option == "--help" || option == "-h") return print_help();
  if (count != 3) return refuse_use("one option and its value are needed");
  if (option == "--connected") {
    int socket = -1;
    const std::string_view number = words[2];
    const auto end = number.data() + number.size();
    if (std::from_chars(number.data(), end, socket).ptr != end || fcntl(socket, F_GETFD) < 0) {
      return refuse_use("--connected needs the number of an open descriptor");
    }
    mauve::guardian::become_urgent();
    mauve::guardian::confine_calls();
    Session(socket).run();
    return 0;
  }
  if (option != "--socket") return refuse_use("there is no such option");
  const int listener = listen_at(words[2]);
  if (listener < 0) return 1;
  mauve::guardian::become_urgent();
  report_ready();
  mauve::guardian::confine_calls();
  serve_all(listener);
}
