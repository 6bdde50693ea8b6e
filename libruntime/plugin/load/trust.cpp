// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/trust.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

namespace mauve::plugin {

namespace {

constexpr int kMostLinks = 40;  // as the kernel has it

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
  if (S_ISLNK(mode)) return false;  // a link is never written to, so its mode has no meaning
  const bool sticky_directory = S_ISDIR(mode) && (mode & S_ISVTX) != 0;
  return (mode & who) != 0 && !sticky_directory;
}

/// The names that are still to be followed, the next one last.
void add_names(const std::string& path, std::vector<std::string>& names) {
  const std::size_t before = names.size();
  for (const auto& part : std::filesystem::path(path).relative_path()) {
    if (!part.empty() && part != ".") names.push_back(part.string());
  }
  std::reverse(names.begin() + static_cast<std::ptrdiff_t>(before), names.end());
}

Error cannot_be_examined(const std::string& path) {
  return refuse({Errc::system, "path_not_examined"}, path,
                std::string("cannot be examined: ") + std::strerror(errno));
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
    return refuse({Errc::plugin_refused, "path_owned_by_other"}, path,
                  "belongs to user " + std::to_string(status.st_uid) +
                      ", who is neither root nor the user of this process",
                  "chown root " + path);
  }
  if (others_may_write(status.st_mode, S_IWOTH)) {
    return refuse({Errc::plugin_refused, "path_writable_by_others"}, path,
                  "may be written by everybody", "chmod o-w " + path);
  }
  if (others_may_write(status.st_mode, S_IWGRP) && !groups.contains(status.st_gid)) {
    return refuse({Errc::plugin_refused, "path_writable_by_others"}, path,
                  "may be written by group " + std::to_string(status.st_gid), "chmod g-w " + path);
  }
  return ok();
}

Status Trust::check_path(const std::string& path) const {
  std::vector<std::string> names;
  add_names(path, names);
  std::string at;  // empty: the root
  struct stat status {};
  if (lstat("/", &status) != 0) return cannot_be_examined("/");
  if (Status trusted = check(status, "/"); !trusted) return trusted;
  for (int links = 0; !names.empty();) {
    const std::string name = std::move(names.back());
    names.pop_back();
    if (name == "..") {
      at.erase(std::min(at.rfind('/'), at.size()));
      continue;
    }
    const std::string next = at + "/" + name;
    if (lstat(next.c_str(), &status) != 0) {
      return errno == ENOENT || errno == ENOTDIR ? ok() : Status(cannot_be_examined(next));
    }
    if (Status trusted = check(status, next); !trusted) return trusted;
    if (!S_ISLNK(status.st_mode)) {
      at = next;
      continue;
    }
    std::error_code failed;
    const auto target = std::filesystem::read_symlink(next, failed);
    if (failed || ++links > kMostLinks) {
      return refuse({Errc::plugin_refused, "path_link_broken"}, next,
                    "is a symbolic link that leads nowhere");
    }
    if (target.is_absolute()) at.clear();
    add_names(target.string(), names);
  }
  return ok();
}

}  // namespace mauve::plugin
