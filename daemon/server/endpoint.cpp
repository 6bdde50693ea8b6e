// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/endpoint.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/fsuid.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "protocol/socket_path.h"

namespace mauve::server {

namespace {

constexpr mode_t kDirectoryMode = 0750;
constexpr mode_t kSocketUmask = 0117;  // leaves 0660
constexpr int kBacklog = 64;

Error system_error(const std::string& at, const std::string& what, std::string hint = {}) {
  return refuse({Errc::system, "socket_failed"}, at, what + ": " + std::strerror(errno),
                std::move(hint));
}

Result<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const auto& text = path.native();
  if (text.empty() || text.size() >= sizeof address.sun_path) {
    return refuse({Errc::limit, "socket_path_too_long"}, text,
                  "a socket path has 1 to 107 characters", "choose a shorter one");
  }
  std::memcpy(address.sun_path, text.c_str(), text.size() + 1);
  return address;
}

/// Files made while this lives belong to the group `mauve`, if we are root and there is one. Only
/// this thread's view of the file system changes, and nothing is chowned by path afterwards.
class AsMauveGroup {
 public:
  AsMauveGroup() {
    if (geteuid() == 0) {
      std::array<char, 4096> buffer{};
      group entry{};
      group* found = nullptr;
      getgrnam_r("mauve", &entry, buffer.data(), buffer.size(), &found);
      if (found != nullptr) {
        setfsgid(found->gr_gid);
      }
    }
  }
  ~AsMauveGroup() { setfsgid(getegid()); }
  AsMauveGroup(const AsMauveGroup&) = delete;
  AsMauveGroup& operator=(const AsMauveGroup&) = delete;
};

/// umask is of the whole process: only while nothing but main runs that makes files.
class WithUmask {
 public:
  explicit WithUmask(mode_t mask) : before_(umask(mask)) {}
  ~WithUmask() { umask(before_); }
  WithUmask(const WithUmask&) = delete;
  WithUmask& operator=(const WithUmask&) = delete;

 private:
  mode_t before_;
};

bool same_file(int fd, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(fd, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

std::string lock_path(const std::filesystem::path& path) { return path.string() + ".lock"; }

}  // namespace

Result<Endpoint> Endpoint::open(const std::filesystem::path& path) {
  std::error_code failed;
  auto absolute = std::filesystem::absolute(path, failed);
  Endpoint endpoint(failed ? path : std::move(absolute));
  if (const auto fits = address_of(endpoint.path_); !fits) {
    return fits.error();
  }
  const AsMauveGroup group;
  if (auto made = endpoint.make_directory(); !made) {
    return made.error();
  }
  if (auto locked = endpoint.take_lock(); !locked) {
    return locked.error();
  }
  if (auto clear = endpoint.clear_dead_socket(); !clear) {
    return clear.error();
  }
  if (auto bound = endpoint.bind_and_listen(); !bound) {
    return bound.error();
  }
  return endpoint;
}

Endpoint::Endpoint(Endpoint&& other) noexcept
    : path_(other.path_),
      lock_(std::exchange(other.lock_, -1)),
      listener_(std::exchange(other.listener_, -1)),
      bound_(std::exchange(other.bound_, false)) {}

Endpoint::~Endpoint() {
  if (listener_ >= 0) {
    close(listener_);
  }
  if (bound_) {
    unlink(path_.c_str());
  }
  if (lock_ >= 0) {
    unlink(lock_path(path_).c_str());
    close(lock_);
  }
}

int Endpoint::release_listener() { return std::exchange(listener_, -1); }

Status Endpoint::make_directory() const {
  const auto directory = path_.parent_path();
  std::error_code failed;
  if (directory.empty() || std::filesystem::exists(directory, failed)) {
    return ok();
  }
  const WithUmask mask(0);
  if (mkdir(directory.c_str(), kDirectoryMode) != 0 && errno != EEXIST) {
    return system_error(directory.string(), "cannot make the directory of the socket",
                        "make it, or choose another place with --socket");
  }
  return ok();
}

Status Endpoint::take_lock() {
  const auto name = lock_path(path_);
  // A mauved that had the lock removes the file when it ends, so the file locked here may be gone
  // by then.
  for (int attempt = 0; attempt < 16; ++attempt) {
    lock_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (lock_ < 0) {
      return system_error(name, "cannot open the lock of the socket", protocol::kUseOwnSocket);
    }
    const bool locked = flock(lock_, LOCK_EX | LOCK_NB) == 0;
    const bool held = !locked && errno == EWOULDBLOCK;
    if (locked && same_file(lock_, name)) {
      return ok();
    }
    close(std::exchange(lock_, -1));
    if (held) {
      return refuse({Errc::conflict, "socket_in_use"}, path_.string(),
                    "another mauved serves this socket",
                    std::string("stop it first, or ") + protocol::kUseOwnSocket);
    }
  }
  return refuse({Errc::conflict, "socket_in_use"}, path_.string(),
                "the lock of the socket changes all the time", "start one mauved at a time");
}

Status Endpoint::clear_dead_socket() const {
  struct stat status {};
  if (lstat(path_.c_str(), &status) != 0) {
    return ok();
  }
  if (!S_ISSOCK(status.st_mode)) {
    return refuse({Errc::conflict, "socket_path_occupied"}, path_.string(),
                  "this is not a socket, and it is left alone",
                  "remove it, or choose another place with --socket");
  }
  const auto address = address_of(path_);
  if (!address) {
    return address.error();
  }
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto* generic = reinterpret_cast<const sockaddr*>(&*address);
  const int rc = connect(probe, generic, sizeof *address);
  const int why = errno;
  close(probe);
  if (rc == 0 || why != ECONNREFUSED) {
    return refuse({Errc::conflict, "socket_in_use"}, path_.string(),
                  "somebody else listens at this socket",
                  std::string("stop it first, or ") + protocol::kUseOwnSocket);
  }
  return unlink(path_.c_str()) == 0 || errno == ENOENT
             ? ok()
             : Status(system_error(path_.string(), "cannot remove a dead socket"));
}

Status Endpoint::bind_and_listen() {
  const auto address = address_of(path_);
  if (!address) {
    return address.error();
  }
  listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0) {
    return system_error(path_.string(), "cannot make a socket");
  }
  const WithUmask mask(kSocketUmask);
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
    return system_error(path_.string(), "cannot bind the socket",
                        "its directory must exist and be writable");
  }
  bound_ = true;
  if (listen(listener_, kBacklog) != 0) {
    return system_error(path_.string(), "cannot listen at the socket");
  }
  return ok();
}

}  // namespace mauve::server
