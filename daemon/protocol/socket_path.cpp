// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/socket_path.h"

#include <unistd.h>

#include <cstdlib>

namespace mauve::protocol {

std::string default_socket_path() {
  const char* chosen = std::getenv("MAUVE_SOCKET");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  const auto user = geteuid();
  if (user == 0) return kServiceSocket;
  const char* runtime_dir = std::getenv("XDG_RUNTIME_DIR");
  const std::string base = runtime_dir != nullptr && *runtime_dir != '\0'
                               ? std::string(runtime_dir)
                               : "/run/user/" + std::to_string(user);
  return base + "/mauve/mauved.sock";
}

}  // namespace mauve::protocol
