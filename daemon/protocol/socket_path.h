// SPDX-License-Identifier: LGPL-3.0-or-later
/// The socket at which daemon and client meet by default.
#pragma once

#include <string>

namespace mauve::protocol {

/// The socket of the mauved that systemd starts.
inline constexpr const char* kServiceSocket = "/run/mauve/mauved.sock";
/// The hint for a user whose mauved cannot have the socket.
inline constexpr const char* kUseOwnSocket =
    "use a socket of your own: export MAUVE_SOCKET=$HOME/mauve.sock, for mauvectl too, or --socket "
    "FILE";

/// $MAUVE_SOCKET; for root kServiceSocket; else $XDG_RUNTIME_DIR/mauve/mauved.sock, and
/// /run/user/UID in place of a variable that is not set. Reads the environment: at start, one
/// thread.
[[nodiscard]] std::string default_socket_path();

}  // namespace mauve::protocol
