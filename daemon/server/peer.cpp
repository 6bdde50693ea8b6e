// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/peer.h"

#include "base/thread_role.h"

#include <grp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

namespace mauve::server {

namespace {

std::optional<gid_t> group_named(const char* name) {
  std::vector<char> buffer(16 * 1024);
  group entry{};
  group* found = nullptr;
  if (getgrnam_r(name, &entry, buffer.data(), buffer.size(), &found) != 0 || found == nullptr) {
    return std::nullopt;
  }
  return found->gr_gid;
}

Error system_error(const char* what) {
  return refuse({Errc::system, "socket_failed"}, "client",
                std::string(what) + ": " + std::strerror(errno));
}

/// The name that the process gives itself. A sandboxed daemon does not see it.
std::string program_of(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
  std::string name;
  std::getline(file, name);
  return name;
}

}  // namespace

Result<Peer> peer_of(int socket) {
  MAUVE_ON_THREAD(io);
  ucred who{};
  socklen_t size = sizeof who;
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) {
    return system_error("SO_PEERCRED");
  }
  // The kernel returns their number when the room is too small.
  std::vector<gid_t> groups(64);
  auto bytes = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  if (getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) {
    if (errno != ERANGE) {
      return system_error("SO_PEERGROUPS");
    }
    groups.resize(bytes / sizeof(gid_t));
    if (getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &bytes) != 0) {
      return system_error("SO_PEERGROUPS");
    }
  }
  groups.resize(bytes / sizeof(gid_t));
  groups.push_back(who.gid);
  return Peer{who.pid, who.uid, std::move(groups), program_of(who.pid)};
}

RoleRules machine_rules() {
  return {geteuid(), group_named("mauve-view"), group_named("mauve"), group_named("mauve-admin")};
}

Role role_of(const Peer& peer, const RoleRules& rules) {
  const auto member = [&](std::optional<gid_t> group) {
    return group && std::find(peer.groups.begin(), peer.groups.end(), *group) != peer.groups.end();
  };
  if (peer.uid == 0 || peer.uid == rules.own_uid || member(rules.admins)) {
    return Role::admin;
  }
  if (member(rules.operators)) {
    return Role::operator_;
  }
  return member(rules.viewers) ? Role::viewer : Role::none;
}

}  // namespace mauve::server
