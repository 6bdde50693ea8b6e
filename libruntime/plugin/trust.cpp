// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/trust.h"

#include <dlfcn.h>
#include <unistd.h>

#include <climits>
#include <cstdlib>
#include <memory>

namespace mauve::plugin {

namespace {

/// Absolute path of the file that holds this function: libmauve, or a program that contains it.
std::string own_file() {
  Dl_info info{};
  const bool known = dladdr(reinterpret_cast<const void*>(&own_file), &info) != 0;
  const char* file = known && info.dli_fname != nullptr && info.dli_fname[0] == '/'
                         ? info.dli_fname
                         : "/proc/self/exe";
  const std::unique_ptr<char, decltype(&std::free)> real(realpath(file, nullptr), &std::free);
  return real ? std::string(real.get()) : std::string();
}

bool others_may_write(mode_t mode, mode_t who) {
  const bool sticky_directory = S_ISDIR(mode) && (mode & S_ISVTX) != 0;
  return (mode & who) != 0 && !sticky_directory;
}

}  // namespace

const Trust& Trust::of_this_process() {
  static const Trust trust = of(geteuid(), own_file());
  return trust;
}

Trust Trust::of(uid_t user, const std::string& library) {
  Trust trust{{0, user}, {}};
  for (std::string path = library; !path.empty(); path.erase(path.rfind('/'))) {
    struct stat status {};
    if (lstat(path.c_str(), &status) != 0) continue;
    trust.owners.insert(status.st_uid);
    if (others_may_write(status.st_mode, S_IWGRP)) trust.groups.insert(status.st_gid);
  }
  return trust;
}

Status Trust::check(const struct stat& status, const std::string& path) const {
  if (!owners.contains(status.st_uid)) {
    return refuse(Errc::plugin_refused, path,
                  "belongs to user " + std::to_string(status.st_uid) +
                      ", who is neither root nor the user of this process",
                  "chown root " + path);
  }
  if (others_may_write(status.st_mode, S_IWOTH)) {
    return refuse(Errc::plugin_refused, path, "may be written by everybody", "chmod o-w " + path);
  }
  if (others_may_write(status.st_mode, S_IWGRP) && !groups.contains(status.st_gid)) {
    return refuse(Errc::plugin_refused, path,
                  "may be written by group " + std::to_string(status.st_gid), "chmod g-w " + path);
  }
  return ok();
}

}  // namespace mauve::plugin
