// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/serial/device_lock.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <utility>

namespace mauve::serial {
namespace {

constexpr int kMostDescriptors = 4096;

bool lock_now(int descriptor) { return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0; }

/// The node of a device that is no longer there.
bool is_unplugged(int error) {
  return error == ENOENT || error == ENODEV || error == ENXIO || error == EIO;
}

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

// A device has no contents, so each place in it can stand for a component of a process.
constexpr std::int64_t kComponents = std::int64_t{1} << 20;  // of one process
constexpr std::int64_t kWaiting = std::int64_t{1} << 50;     // first place of those that wait

struct flock record(short kind, std::int64_t first, std::int64_t count) {
  struct flock places {};
  places.l_type = kind;
  places.l_whence = SEEK_SET;
  places.l_start = first;
  places.l_len = count;
  return places;
}

void mark(int descriptor, std::int64_t place) {
  struct flock places = record(F_RDLCK, place, 1);
  static_cast<void>(::fcntl(descriptor, F_OFD_SETLK, &places));
}

/// By another descriptor than this one.
bool is_marked(int descriptor, std::int64_t first, std::int64_t count) {
  if (count == 0) return false;  // which would mean: to the end
  struct flock places = record(F_WRLCK, first, count);
  return ::fcntl(descriptor, F_OFD_GETLK, &places) == 0 && places.l_type != F_UNLCK;
}

/// Of this process.
std::int64_t first_place() { return ::getpid() * kComponents; }

void close_now(int& descriptor) {
  if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
}

}  // namespace

void DeviceLock::belongs_to(std::string_view address) {
  const std::string_view component = address.substr(0, address.find('.'));
  const auto number = std::hash<std::string_view>{}(component);
  place_ = component.empty() ? -1 : first_place() + static_cast<std::int64_t>(number % kComponents);
}

/// A line marks the device before it asks for the lock, so the line that comes second sees the
/// mark.
DeviceLock::Found DeviceLock::take(int line, const char* path, Opening opening) {
  release();
  struct stat device {};
  struct stat opened {};
  if (::fstat(line, &device) != 0) return Found::free;
  for (int* const its : {&own_, &lock_}) {
    *its = ::open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (*its < 0 && errno == EACCES) {  // a line that is written only
      *its = ::open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    }
    if (*its < 0 && !is_unplugged(errno)) return unknown();
    const bool same = *its >= 0 && ::fstat(*its, &opened) == 0 && device.st_rdev == opened.st_rdev;
    if (!same) return Found::free;  // unplugged at this moment: the line notices that
  }
  if (place_ >= 0) mark(own_, place_);
  if (lock_now(lock_)) return Found::free;
  if (errno != EWOULDBLOCK) return unknown();
  close_now(lock_);
  if (place_ >= 0) {
    const std::int64_t first = first_place();
    const bool others = is_marked(own_, first, place_ - first) ||
                        is_marked(own_, place_ + 1, first + kComponents - place_ - 1);
    const bool waits = opening == Opening::again || is_marked(own_, kWaiting + place_, 1);
    if (others && waits) {
      wait_for_it();
      return Found::other_component;
    }
  }
  lock_ = copy_of_own_lock(device, own_);
  shared_ = lock_ >= 0;
  if (shared_) return Found::free;
  release();
  return Found::other_process;
}

DeviceLock::Found DeviceLock::unknown() {
  const int why = errno;
  release();
  errno = why;
  return Found::unknown;
}

/// Until release(), or the next take().
void DeviceLock::wait_for_it() {
  struct flock places = record(F_UNLCK, place_, 1);
  static_cast<void>(::fcntl(own_, F_OFD_SETLK, &places));
  mark(own_, kWaiting + place_);
}

bool DeviceLock::is_awaited() const {
  if (own_ < 0 || place_ < 0) return false;
  const std::int64_t first = first_place();
  return is_marked(own_, kWaiting + first, place_ - first) ||
         is_marked(own_, kWaiting + place_ + 1, first + kComponents - place_ - 1);
}

void DeviceLock::release() {
  close_now(lock_);
  close_now(own_);
  shared_ = false;
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
