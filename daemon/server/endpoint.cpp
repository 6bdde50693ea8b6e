// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/endpoint.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/fsuid.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "protocol/socket_path.h"
#include "server/peer.h"

namespace mauve::server {

namespace {

constexpr mode_t kDirectoryMode = 0750;
constexpr mode_t kSocketMode = 0660;
constexpr int kBacklog = 512;

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
                  "this path of a socket has no room in its address: 107 characters",
                  "choose a path of at most 102 characters: the one for stops ends in .stop");
  }
  std::memcpy(address.sun_path, text.c_str(), text.size() + 1);
  return address;
}

/// Files made while this lives belong to the group `mauve`, if we are root and there is one. Only
/// this thread's view of the file system changes, and nothing is chowned by path afterwards.
class AsMauveGroup {
 public:
  AsMauveGroup() {
    if (const auto mauve = machine_rules().operators; geteuid() == 0 && mauve) {
      setfsgid(*mauve);
    }
  }
  ~AsMauveGroup() { setfsgid(getegid()); }
  AsMauveGroup(const AsMauveGroup&) = delete;
  AsMauveGroup& operator=(const AsMauveGroup&) = delete;
};

bool same_file(int fd, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(fd, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

std::string lock_path(const std::filesystem::path& path) { return path.string() + ".lock"; }

/// The access list of a socket that the owner, its group and the group of the admins may open.
/// Without that group, and where a file system has no lists, the mode decides alone.
Status permit_admins(const std::string& file, std::optional<gid_t> admins) {
  struct Entry {
    std::uint16_t tag;
    std::uint16_t permissions;
    std::uint32_t id;
  };
  struct List {
    std::uint32_t version;
    std::array<Entry, 5> entries;
  };
  constexpr std::uint16_t kReadWrite = 6;
  constexpr auto kNobody = static_cast<std::uint32_t>(-1);
  constexpr const char* kName = "system.posix_acl_access";
  if (!admins) {
    removexattr(file.c_str(), kName);
    return ok();
  }
  // Owner, its group, the named group, the mask of both groups, all others: see acl(5).
  const List list{2,
                  {{{0x01, kReadWrite, kNobody},
                    {0x04, kReadWrite, kNobody},
                    {0x08, kReadWrite, *admins},
                    {0x10, kReadWrite, kNobody},
                    {0x20, 0, kNobody}}}};
  if (setxattr(file.c_str(), kName, &list, sizeof list, 0) != 0 && errno != EOPNOTSUPP) {
    return system_error(file, "cannot set the access list of the socket");
  }
  return ok();
}

/// A directory may give new files an access list by default, with viewers in it. So a socket is
/// bound for its owner alone, and its rights come before it listens.
Status set_rights(int file, Way way) {
  const auto name = "/proc/self/fd/" + std::to_string(file);
  if (way == Way::stop) {
    if (auto permitted = permit_admins(name, machine_rules().admins); !permitted) {
      return permitted;
    }
  }
  return chmod(name.c_str(), kSocketMode) == 0
             ? ok()
             : Status(system_error(name, "cannot set the rights of the socket"));
}

/// Removes a socket at which no daemon answers.
Status clear_dead_socket(const std::filesystem::path& path) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0) {
    return ok();
  }
  if (!S_ISSOCK(status.st_mode)) {
    return refuse({Errc::conflict, "socket_path_occupied"}, path.string(),
                  "this is not a socket, and it is left alone",
                  "remove it, or choose another place with --socket");
  }
  const auto address = address_of(path);
  if (!address) {
    return address.error();
  }
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) {
    return system_error(path.string(), "cannot make a socket");
  }
  const auto* generic = reinterpret_cast<const sockaddr*>(&*address);
  const int rc = connect(probe, generic, sizeof *address);
  const int why = errno;
  close(probe);
  if (rc != 0 && why != ECONNREFUSED && why != EAGAIN) {
    errno = why;
    return system_error(path.string(), "cannot find out whether somebody listens at this socket",
                        std::string("remove it, or ") + protocol::kUseOwnSocket);
  }
  if (rc == 0 || why == EAGAIN) {
    return refuse({Errc::conflict, "socket_in_use"}, path.string(),
                  "somebody else listens at this socket",
                  std::string("stop it first, or ") + protocol::kUseOwnSocket);
  }
  return unlink(path.c_str()) == 0 || errno == ENOENT
             ? ok()
             : Status(system_error(path.string(), "cannot remove a dead socket"));
}

}  // namespace

Endpoint::Endpoint(const std::filesystem::path& path) {
  at(Way::all).path = path;
  at(Way::stop).path = path.string() + protocol::kStopSuffix;
}

Result<Endpoint> Endpoint::open(const std::filesystem::path& path) {
  std::error_code failed;
  const auto absolute = std::filesystem::absolute(path, failed);
  Endpoint endpoint(failed ? path : absolute);
  for (const auto way : kWays) {
    if (const auto fits = address_of(endpoint.path(way)); !fits) {
      return fits.error();
    }
  }
  for (const auto way : kWays) {
    if (auto bound = endpoint.bind_again(way); !bound) {
      return bound.error();
    }
  }
  return endpoint;
}

Endpoint::Endpoint(Endpoint&& other) noexcept
    : bound_(std::exchange(other.bound_, {})), lock_(std::exchange(other.lock_, -1)) {}

Endpoint::~Endpoint() {
  for (const auto way : kWays) {
    if (at(way).listener >= 0) {
      close(at(way).listener);
    }
  }
  remove_names();
  if (lock_ >= 0) {
    if (same_file(lock_, lock_path(path()))) {
      unlink(lock_path(path()).c_str());
    }
    close(lock_);
  }
}

void Endpoint::remove_names() const {
  for (const auto way : kWays) {
    if (is_there(way)) {
      unlink(at(way).path.c_str());
    }
  }
}

int Endpoint::release_listener(Way way) { return std::exchange(at(way).listener, -1); }

bool Endpoint::is_there(Way way) const {
  struct stat named {};
  return at(way).inode != 0 && lstat(at(way).path.c_str(), &named) == 0 &&
         named.st_ino == at(way).inode && named.st_dev == at(way).device;
}

Status Endpoint::bind_again(Way way) {
  const AsMauveGroup group;
  if (auto made = make_directory(); !made) {
    return made;
  }
  if (auto locked = take_lock(); !locked) {
    return locked;
  }
  if (is_there(way)) {  // nobody listens at it any more
    unlink(path(way).c_str());
  }
  at(way).inode = 0;
  if (auto clear = clear_dead_socket(path(way)); !clear) {
    return clear;
  }
  return bind_and_listen(way);
}

Status Endpoint::make_directory() const {
  const auto directory = path().parent_path();
  std::error_code failed;
  if (directory.empty() || std::filesystem::exists(directory, failed)) {
    return ok();
  }
  if (mkdir(directory.c_str(), kDirectoryMode) != 0 && errno != EEXIST) {
    return system_error(directory.string(), "cannot make the directory of the socket",
                        "make it, or choose another place with --socket");
  }
  return ok();
}

Status Endpoint::take_lock() {
  const auto name = lock_path(path());
  if (lock_ >= 0 && same_file(lock_, name)) {
    return ok();
  }
  // A mauved that had the lock removes the file when it ends, so the file locked here may be gone
  // by then.
  for (int attempt = 0; attempt < 16; ++attempt) {
    const int lock = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (lock < 0) {
      return system_error(name, "cannot open the lock of the socket", protocol::kUseOwnSocket);
    }
    const bool locked = flock(lock, LOCK_EX | LOCK_NB) == 0;
    const int why = locked ? 0 : errno;
    if (locked && same_file(lock, name)) {
      if (const int before = std::exchange(lock_, lock); before >= 0) {
        close(before);
      }
      return ok();
    }
    close(lock);
    if (!locked && why != EWOULDBLOCK) {
      errno = why;
      return system_error(name, "cannot lock it, so another mauved could serve the same socket",
                          "choose a place on a disk of this machine with --socket");
    }
    if (!locked) {
      return refuse({Errc::conflict, "socket_in_use"}, path().string(),
                    "another mauved serves this socket",
                    std::string("stop it first, or ") + protocol::kUseOwnSocket);
    }
  }
  return refuse({Errc::conflict, "socket_in_use"}, path().string(),
                "the lock of the socket changes all the time", "start one mauved at a time");
}

/// Without umask(), which is of the whole process: other threads may make files meanwhile.
Status Endpoint::bind_and_listen(Way way) {
  auto& bound = at(way);
  const auto name = bound.path.string();
  const auto address = address_of(bound.path);
  if (!address) {
    return address.error();
  }
  if (bound.listener >= 0) {
    close(bound.listener);
  }
  bound.listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (bound.listener < 0) {
    return system_error(name, "cannot make a socket");
  }
  fchmod(bound.listener, S_IRUSR | S_IWUSR);
  if (bind(bound.listener, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
    return system_error(name, "cannot bind the socket", "its directory must exist and be writable");
  }
  const int file = ::open(name.c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC);
  struct stat made {};
  if (file < 0 || fstat(file, &made) != 0 || !S_ISSOCK(made.st_mode)) {
    const auto error = system_error(name, "cannot open the socket that was just bound");
    close(file);
    return error;
  }
  bound.device = made.st_dev;
  bound.inode = made.st_ino;
  const auto permitted = set_rights(file, way);
  close(file);
  if (!permitted) {
    return permitted;
  }
  return listen(bound.listener, kBacklog) == 0
             ? ok()
             : Status(system_error(name, "cannot listen at the socket"));
}

}  // namespace mauve::server
