// SPDX-License-Identifier: LGPL-3.0-or-later
/// The identity of the process at the other end of a connection, as the kernel reports it, and its
/// role.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <mauve/result.h>

#include "protocol/methods.h"

namespace mauve::server {

using protocol::Role;
using protocol::to_string;

/// Frozen by the kernel at connect. The pid is for the log only: it may be reused.
struct Peer {
  pid_t pid = 0;
  uid_t uid = 0;
  std::vector<gid_t> groups;  ///< primary and supplementary
  std::string program = {};   ///< name of the process at connect, for the log only; may be empty
};

/// [io] SO_PEERCRED and SO_PEERGROUPS of a connected Unix socket.
[[nodiscard]] Result<Peer> peer_of(int socket);

/// The rules that give a role to a user. A group that does not exist on this machine gives no role.
struct RoleRules {
  uid_t own_uid = 0;  ///< the user the daemon runs as: admin, since he could attach a debugger
  std::optional<gid_t> viewers;
  std::optional<gid_t> operators;
  std::optional<gid_t> admins;
};

/// [main] or [io] The rules of this machine: groups mauve-view, mauve, mauve-admin and the
/// effective uid.
[[nodiscard]] RoleRules machine_rules();

/// [any] The highest role that a rule gives.
[[nodiscard]] Role role_of(const Peer& peer, const RoleRules& rules);

}  // namespace mauve::server
