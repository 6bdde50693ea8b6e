// SPDX-License-Identifier: LGPL-3.0-or-later
/// daemon.doctor: the privileges of this process, and its directories. `mauvectl doctor` judges
/// them, together with its own findings on the machine.
#include <gnu/libc-version.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cstdlib>

#include "commands/command.h"
#include "options.h"
#include "plugin/load/trust.h"
#include "rt/process/process.h"
#include "state/state_store.h"

namespace mauve::daemon {
namespace {

template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json directory_json(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    return {{"path", path}, {"exists", false}};
  }
  return {{"path", path},
          {"exists", S_ISDIR(status.st_mode)},
          {"uid", status.st_uid},
          {"mode", status.st_mode & 07777U}};
}

Json plugin_directory_json(const std::string& path) {
  Json directory = directory_json(path);
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    const auto trusted = plugin::Trust::of_this_process().check(status, path);
    if (!trusted) {
      directory["problem"] = trusted.error().message;
      directory["hint"] = trusted.error().hint;
    }
  }
  return directory;
}

Json state_directory_json(const std::string& path) {
  Json directory = directory_json(path);
  struct statvfs disk {};
  if (statvfs(path.c_str(), &disk) == 0) {
    directory["free_bytes"] = static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
    directory["total_bytes"] = static_cast<std::uint64_t>(disk.f_blocks) * disk.f_frsize;
  }
  return directory;
}

/// Only those that are not trusted.
Json distrusted_json(const Running& running) {
  Json all = Json::array();
  for (const auto& deciding : running.deciding) {
    if (const auto distrust = distrust_of(deciding)) {
      all.push_back({{"what", deciding.what},
                     {"path", distrust->at},
                     {"problem", distrust->message},
                     {"hint", distrust->hint}});
    }
  }
  return all;
}

Json threads_json() {
  Json threads = Json::array();
  for (const auto& one : rt::threads_of("/", "self")) {
    threads.push_back(
        {{"name", one.name}, {"policy", one.policy}, {"priority", one.priority}, {"cpu", one.cpu}});
  }
  return threads;
}

}  // namespace

Result<Json> doctor(Running& running, const Call& /*call*/) {
  const auto facts = rt::process_facts("/", "self");
  Json plugin_dirs = Json::array();
  for (const auto& path : running.catalog.directories()) {
    plugin_dirs.push_back(plugin_directory_json(path));
  }
  return Json{
      {"pid", getpid()},
      {"uid", geteuid()},
      {"service", std::getenv("NOTIFY_SOCKET") != nullptr},
      {"realtime", word_of(running.realtime)},
      {"rtprio", facts.priority_limit},
      {"memlock", or_null(facts.lock_limit)},
      {"sys_nice", facts.nice_capability},
      {"ipc_lock", facts.lock_capability},
      {"locked_kib", facts.locked_kib},
      {"cpu_group", facts.cpu_group},
      {"rt_runtime_us", or_null(facts.group_runtime_us)},
      {"threads", threads_json()},
      {"plugin_dirs", std::move(plugin_dirs)},
      {"state_dir",
       running.store == nullptr ? Json() : state_directory_json(running.store->directory())},
      {"distrusted", distrusted_json(running)},
      {"glibc", gnu_get_libc_version()}};
}

}  // namespace mauve::daemon
