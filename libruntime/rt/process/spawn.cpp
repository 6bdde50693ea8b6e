// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/spawn.h"

#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <cstring>

namespace mauve::rt {
namespace {

/// The settings that posix_spawn needs; the object owns memory.
class SpawnSettings {
 public:
  explicit SpawnSettings(const std::vector<int>& descriptors) {
    posix_spawn_file_actions_init(&files_);
    int number = 0;
    for (const int descriptor : descriptors) {
      posix_spawn_file_actions_adddup2(&files_, descriptor, number++);
    }
    posix_spawn_file_actions_addclosefrom_np(&files_, number);
    posix_spawnattr_init(&attributes_);
    sigset_t none{};
    sigset_t all{};
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setpgroup(&attributes_, 0);
    const sched_param ordinary{};
    posix_spawnattr_setschedpolicy(&attributes_, SCHED_OTHER);
    posix_spawnattr_setschedparam(&attributes_, &ordinary);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF |
                                               POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSCHEDULER);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t& files() const { return files_; }
  [[nodiscard]] const posix_spawnattr_t& attributes() const { return attributes_; }

 private:
  posix_spawn_file_actions_t files_{};
  posix_spawnattr_t attributes_{};
};

}  // namespace

Result<pid_t> spawn(const std::vector<std::string>& command, const std::vector<int>& descriptors) {
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (const auto& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const SpawnSettings settings(descriptors);
  pid_t child = 0;
  const int refused = posix_spawn(&child, words.front(), &settings.files(), &settings.attributes(),
                                  words.data(), environ);
  if (refused == 0) return child;
  return refuse({Errc::system, "process_not_started"}, {},
                "cannot start " + command.front() + ": " + std::strerror(refused));
}

}  // namespace mauve::rt
