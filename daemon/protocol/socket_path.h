// SPDX-License-Identifier: LGPL-3.0-or-later
/// The socket at which daemon and client meet by default.
#pragma once

#include <sys/types.h>

#include <string>

namespace mauve::protocol {

/// The socket of the mauved that systemd starts.
inline constexpr const char* kServiceSocket = "/run/mauve/mauved.sock";
/// Behind the path of the socket: that of the socket for stop, confirm and undo only, which viewers
/// cannot open.
inline constexpr const char* kStopSuffix = ".stop";
/// The hint for a user whose mauved cannot have the socket.
inline constexpr const char* kUseOwnSocket =
    "use a socket of your own: export MAUVE_SOCKET=$HOME/mauve.sock, for mauvectl too, or --socket "
    "FILE";

/// $MAUVE_SOCKET; for root kServiceSocket; else $XDG_RUNTIME_DIR/mauve/mauved.sock, and
/// /run/user/UID in place of a variable that is not set. Reads the environment: at start, one
/// thread.
[[nodiscard]] std::string default_socket_path();

/// May a process of the user `listener` be the mauved behind the socket at `path`? That of root or
/// of this user may. That of another user may where the directory of the socket is that user's.
/// Neither that directory nor one above it may be writable by everybody, who could listen first.
[[nodiscard]] bool may_be_mauved(const std::string& path, uid_t listener);

}  // namespace mauve::protocol
