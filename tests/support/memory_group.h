// SPDX-License-Identifier: LGPL-3.0-or-later
/// A control group in which the kernel kills a process that takes too much memory.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace mauve::test {

/// Of version 1 or 2 of control groups; made and left as root, where they are mounted writable.
class MemoryGroup {
 public:
  MemoryGroup() {
    namespace fs = std::filesystem;
    std::error_code none;
    for (const char* root : {"/sys/fs/cgroup/memory", "/sys/fs/cgroup"}) {
      place_ = fs::path(root) / ("mauve_test_" + std::to_string(getpid()));
      if (!fs::create_directory(place_, none)) continue;
      for (const char* name : {"memory.limit_in_bytes", "memory.max"}) {
        if (fs::exists(place_ / name)) limit_ = place_ / name;
      }
      if (!limit_.empty()) return;
      fs::remove(place_, none);
    }
  }
  ~MemoryGroup() {
    if (!limit_.empty()) rmdir(place_.c_str());
  }
  MemoryGroup(const MemoryGroup&) = delete;
  MemoryGroup& operator=(const MemoryGroup&) = delete;

  /// Can there be one here?
  explicit operator bool() const { return !limit_.empty(); }
  /// From now on the process may take so much more memory. The memory that it has already does not
  /// count.
  [[nodiscard]] bool take(pid_t process, std::size_t bytes) const {
    return write(limit_, std::to_string(bytes)) &&
           write(place_ / "cgroup.procs", std::to_string(process));
  }

 private:
  static bool write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream into(file);
    into << text;
    into.close();
    return !into.fail();
  }

  std::filesystem::path place_;
  std::filesystem::path limit_;
};

}  // namespace mauve::test
