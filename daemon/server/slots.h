// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rules by which a newcomer gets a connection, and by which another client may lose its own.
/// Plain functions of the clients that are connected.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <mauve/result.h>

#include "server/limits.h"
#include "server/peer.h"

namespace mauve::server {

/// One connection that is there.
struct Slot {
  std::uint64_t client = 0;
  uid_t uid = 0;
  Role role = Role::none;
  bool only_urgent = false;
  /// Has its first answer, and asks nothing now: only then does it lose nothing with its place.
  bool idle = false;
};

/// How a newcomer is admitted.
struct Entry {
  std::string_view only_urgent_since = {};  ///< why it may only stop; empty: it may do all
  std::uint64_t displaced = 0;              ///< the client whose slot it gets; 0: none
};

inline constexpr std::string_view kAllSlotsInUse = "all connection slots are in use";
inline constexpr std::string_view kNoDescriptor = "mauved has no file descriptor left";
inline constexpr std::string_view kWayOfStops = "this socket is for stop, confirm and undo";

/// Viewers never keep an operator or admin out, and an operator or admin may stop the machine even
/// when all connection slots of this user are in use. `slots` has the oldest client first;
/// `only_urgent_since`: why the newcomer may not do more in any case, empty for none.
[[nodiscard]] Result<Entry> entry_for(const Peer& peer, Role role,
                                      std::string_view only_urgent_since, const Limits& limits,
                                      const std::vector<Slot>& slots);

/// The oldest idle client that may only stop; 0: there is none.
[[nodiscard]] std::uint64_t oldest_idle_stop(const std::vector<Slot>& slots);

}  // namespace mauve::server
