// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/plugin_file.h"

#include <dirent.h>
#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "base/address.h"
#include "base/name.h"
#include "plugin/elf/elf.h"
#include "rt/process/descriptor.h"

namespace mauve::plugin {

namespace {

constexpr std::string_view kSuffix = ".so";

Error system_error(std::string at, std::string_view doing) {
  return refuse({Errc::plugin_refused, "plugin_unreadable"}, std::move(at),
                "cannot be " + std::string(doing) + ": " + std::strerror(errno));
}

/// Opens one step below `parent` (the root when `name` is "/") and checks its owner.
Result<rt::Descriptor> step(const rt::Descriptor& parent, const std::string& name,
                            const std::string& path, const Trust& trust) {
  rt::Descriptor opened(openat(parent ? parent.get() : AT_FDCWD, name.c_str(),
                               O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat status {};
  if (!opened || fstat(opened.get(), &status) != 0) return system_error(path, "opened");
  if (Status trusted = trust.check(status, path); !trusted) return trusted.error();
  return opened;
}

/// Walks from the root, so that no directory on the way can have been exchanged unnoticed.
Result<rt::Descriptor> open_directory(const std::string& path, const Trust& trust) {
  Result<rt::Descriptor> at = step({}, "/", "/", trust);
  for (std::size_t begin = 1; at && begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    at = step(*at, path.substr(begin, end - begin), path.substr(0, end), trust);
    begin = end + 1;
  }
  return at;
}

/// Empty when there is no such directory.
std::string real_path(const std::string& directory) {
  const std::unique_ptr<char, decltype(&std::free)> real(realpath(directory.c_str(), nullptr),
                                                         &std::free);
  return real ? std::string(real.get()) : std::string();
}

Status check_file(int file, const std::string& path, const Trust& trust, std::size_t& size) {
  struct stat status {};
  if (fstat(file, &status) != 0) return system_error(path, "examined");
  if (!S_ISREG(status.st_mode)) {
    return refuse({Errc::plugin_refused, "plugin_not_a_file"}, path, "is not a regular file");
  }
  if (Status trusted = trust.check(status, path); !trusted) return trusted;
  size = static_cast<std::size_t>(status.st_size);
  if (size > kLargestPlugin) {
    return refuse({Errc::limit, "plugin_too_large"}, path, "is larger than 256 MiB",
                  "strip its debug information");
  }
  return ok();
}

/// A file that shrinks meanwhile gives fewer bytes, and the check of the ELF header refuses them.
Status read_all(int file, const std::string& path, std::vector<std::byte>& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = read(file, bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return system_error(path, "read");
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return ok();
}

std::string path_in(const std::string& directory, std::string_view name) {
  return (directory == "/" ? "" : directory) + "/" + std::string(name) + std::string(kSuffix);
}

/// Nothing: the directory has no such file.
std::optional<Result<PluginFile>> read_from(const std::string& directory, std::string_view name,
                                            const Trust& trust) {
  const std::string real = real_path(directory);
  if (real.empty()) return std::nullopt;
  PluginFile plugin;
  plugin.name = name;
  plugin.path = path_in(real, name);
  struct stat link {};
  if (lstat(plugin.path.c_str(), &link) != 0 && errno == ENOENT) return std::nullopt;
  const Result<rt::Descriptor> folder = open_directory(real, trust);
  if (!folder) return folder.error();
  const std::string file_name = plugin.name + std::string(kSuffix);
  const rt::Descriptor file(openat(folder->get(), file_name.c_str(),
                                   O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file && errno == ELOOP) {
    return refuse({Errc::plugin_refused, "plugin_is_link"}, plugin.path, "is a symbolic link",
                  "copy the file itself");
  }
  if (!file) return system_error(plugin.path, "opened");
  std::size_t size = 0;
  if (Status good = check_file(file.get(), plugin.path, trust, size); !good) return good.error();
  plugin.bytes.resize(size);
  if (Status done = read_all(file.get(), plugin.path, plugin.bytes); !done) return done.error();
  return plugin;
}

struct CloseListing {
  void operator()(DIR* listing) const { closedir(listing); }
};

std::vector<std::string> names_in(const std::vector<std::string>& directories) {
  std::vector<std::string> names;
  for (const std::string& directory : directories) {
    const std::unique_ptr<DIR, CloseListing> listing(opendir(directory.c_str()));
    if (!listing) continue;
    while (const dirent* entry = readdir(listing.get())) {
      const std::string_view file = entry->d_name;
      if (!file.ends_with(kSuffix)) continue;
      const std::string_view name = file.substr(0, file.size() - kSuffix.size());
      if (is_name(name)) names.emplace_back(name);
    }
  }
  return names;
}

bool exists_in(const std::string& directory, std::string_view name) {
  return access(path_in(directory, name).c_str(), F_OK) == 0;
}

/// A directory that is named twice, or under two names, hides nothing.
std::vector<std::string> hidden_by(const PluginFile& plugin,
                                   std::span<const std::string> directories) {
  std::vector<std::string> hidden;
  for (const std::string& directory : directories) {
    const std::string path = path_in(real_path(directory), plugin.name);
    const bool new_one = path != plugin.path && std::ranges::find(hidden, path) == hidden.end();
    if (new_one && exists_in(directory, plugin.name)) hidden.push_back(path);
  }
  return hidden;
}

Error not_found(const std::vector<std::string>& directories, std::string_view name) {
  std::string hint = did_you_mean(name, names_in(directories), "\"");
  if (hint.empty()) {
    hint = exists_in(installed_directory(), name)
               ? "it is in " + installed_directory() + ": name that with --plugin-dir of mauved too"
               : "mauved looks nowhere else; its option --plugin-dir names more directories";
  }
  std::string where;
  for (const std::string& directory : directories) {
    where += (where.empty() ? "" : ", ") + directory;
    if (real_path(directory).empty()) where += " (no such directory)";
  }
  return refuse({Errc::plugin_refused, "plugin_not_found"}, std::string(name),
                where.empty() ? "cannot be found: there is no plugin directory"
                              : "there is no " + std::string(name) + ".so in " + where,
                std::move(hint));
}

}  // namespace

std::string installed_directory() {
  std::error_code failed;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
  const auto beside = program.parent_path().parent_path() / "lib" / "mauve" / "plugins";
  if (!failed && std::filesystem::is_directory(beside, failed)) return beside.string();
  return MAUVE_INSTALL_PLUGINDIR;
}

Result<PluginFile> read_plugin_file(const std::vector<std::string>& directories,
                                    std::string_view name, const Trust& trust) {
  if (!is_name(name)) {
    return refuse({Errc::invalid_value, "plugin_name_invalid"},
                  std::string(name.substr(0, kLongestAddress)), "is not the name of a plugin",
                  "the name is the file's, without directory and without .so");
  }
  for (std::size_t i = 0; i < directories.size(); ++i) {
    auto found = read_from(directories[i], name, trust);
    if (!found) continue;
    if (*found) (*found)->hides = hidden_by(**found, std::span(directories).subspan(i + 1));
    return *std::move(found);
  }
  return not_found(directories, name);
}

Result<std::string> build_on_disk(const std::vector<std::string>& directories,
                                  std::string_view name, const Trust& trust) {
  const auto file = read_plugin_file(directories, name, trust);
  if (!file) return file.error();
  auto facts = inspect(file->bytes, name);
  if (!facts) return facts.error();
  return std::move(facts->build_id);
}

}  // namespace mauve::plugin
