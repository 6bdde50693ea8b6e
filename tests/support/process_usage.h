// SPDX-License-Identifier: LGPL-3.0-or-later
/// The resources of the machine that a process holds: memory, descriptors, threads.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace mauve::test {

/// The number of entries of a folder of /proc/PROCESS: "fd", "task".
inline std::size_t entries(pid_t process, const std::string& what) {
  const auto folder = std::filesystem::path("/proc") / std::to_string(process) / what;
  std::error_code gone;
  std::size_t count = 0;
  for (auto i = std::filesystem::directory_iterator(folder, gone); i != end(i); ++i) ++count;
  return count;
}

/// Its resident memory in bytes, 0 when it is gone.
inline std::int64_t resident_bytes(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/statm");
  std::int64_t size = 0;
  std::int64_t resident = 0;
  file >> size >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

}  // namespace mauve::test
