// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/socket_path.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

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

bool may_be_mauved(const std::string& path, uid_t listener) {
  if (listener == 0 || listener == geteuid()) return true;
  std::error_code failed;
  auto folder = std::filesystem::absolute(path, failed).parent_path();
  struct stat its {};
  if (failed || stat(folder.c_str(), &its) != 0 || its.st_uid != listener) return false;
  for (; stat(folder.c_str(), &its) == 0; folder = folder.parent_path()) {
    if ((its.st_mode & S_IWOTH) != 0) return false;
    if (folder == folder.root_path()) return true;
  }
  return false;
}

}  // namespace mauve::protocol
