// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/device_lock.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

namespace mauve::serial {
namespace {

constexpr int kMostDescriptors = 4096;

bool lock_now(int descriptor) { return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0; }

/// A copy of the descriptor on which this process holds the lock of the device; -1: it does not.
int copy_of_own_lock(const struct stat& device, int except) {
  for (int number = 0; number < kMostDescriptors; ++number) {
    struct stat facts {};
    if (number == except || ::fstat(number, &facts) != 0) continue;
    if (facts.st_dev != device.st_dev || facts.st_ino != device.st_ino) continue;
    const int copy = ::fcntl(number, F_DUPFD_CLOEXEC, 0);
    if (copy >= 0 && lock_now(copy)) return copy;
    if (copy >= 0) ::close(copy);
  }
  return -1;
}

}  // namespace

bool DeviceLock::take(int line, const char* path) {
  release();
  struct stat device {};
  struct stat opened {};
  const int own = ::open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  const bool same = own >= 0 && ::fstat(line, &device) == 0 && ::fstat(own, &opened) == 0 &&
                    device.st_rdev == opened.st_rdev;
  lock_ = own;
  if (!same) return true;  // unplugged at this moment: the line notices that
  if (lock_now(own)) return true;
  const int shared = copy_of_own_lock(device, own);
  release();
  lock_ = shared;
  return shared >= 0;
}

void DeviceLock::release() {
  if (lock_ >= 0) ::close(std::exchange(lock_, -1));
}

std::string holder_of(const std::string& path) {
  struct stat device {};
  if (::stat(path.c_str(), &device) != 0) return "another process";
  std::array<char, 64> place{};
  std::snprintf(place.data(), place.size(), "%02x:%02x:%llu", major(device.st_dev),
                minor(device.st_dev), static_cast<unsigned long long>(device.st_ino));
  std::ifstream locks("/proc/locks");  // "1: FLOCK ADVISORY WRITE 4711 00:05:123 0 EOF"
  for (std::string line; std::getline(locks, line);) {
    std::istringstream fields(line);
    std::string number;
    std::string kind;
    std::string way;
    std::string use;
    std::string process;
    std::string where;
    fields >> number >> kind >> way >> use >> process >> where;
    if (kind != "FLOCK" || where != place.data()) continue;
    std::string name;
    std::getline(std::ifstream("/proc/" + process + "/comm"), name);
    return "process " + process + (name.empty() ? "" : " (" + name + ")");
  }
  return "another process";
}

}  // namespace mauve::serial
