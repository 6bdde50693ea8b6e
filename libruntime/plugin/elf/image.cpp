// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/image.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

#ifndef MFD_EXEC
#define MFD_EXEC 0x0010U
#endif

namespace mauve::plugin {

namespace {

Error failed(const char* doing) {
  return refuse({Errc::system, "plugin_not_copied"}, {},
                std::string("cannot ") + doing + ": " + std::strerror(errno));
}

/// Kernels before 6.3 do not know MFD_EXEC; later ones may insist on it (vm.memfd_noexec).
int memory_file(const std::string& name) {
  const int file = memfd_create(name.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING | MFD_EXEC);
  if (file >= 0 || errno != EINVAL) return file;
  return memfd_create(name.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING);
}

Status write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return failed("copy the plugin into memory");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return ok();
}

}  // namespace

Result<Image> Image::seal(std::span<const std::byte> bytes, const std::string& label) {
  static std::atomic<std::size_t> serials{0};
  Image image;
  image.serial_ = ++serials;
  const std::string name = "mauve:" + label + "." + std::to_string(image.serial_);
  image.mapping_ = "/memfd:" + name;
  image.file_ = rt::Descriptor(memory_file(name));
  if (!image.file_) return failed("make a memory file for the plugin");
  if (Status written = write_all(image.file_.get(), bytes); !written) return written.error();
  if (Status sealed = seal_file(image.file_.get()); !sealed) return sealed.error();
  return image;
}

Status seal_file(int file, const std::function<void()>& before_retry) {
  constexpr int kSeals = F_SEAL_WRITE | F_SEAL_GROW | F_SEAL_SHRINK | F_SEAL_SEAL;
  constexpr int kAttempts = 10;
  for (int attempt = 1; fcntl(file, F_ADD_SEALS, kSeals) != 0; ++attempt) {
    if (errno != EBUSY || attempt == kAttempts) return failed("seal the plugin's copy");
    before_retry();
  }
  return ok();
}

std::string Image::path() const {
  const std::string file = "/fd/" + std::to_string(file_.get());
  // With the number of the process, not "self": a debugger can then read the file too. In a
  // container /proc may count processes in another way.
  const std::string numbered = "/proc/" + std::to_string(getpid()) + file;
  struct stat named {};
  struct stat own {};
  const bool same = stat(numbered.c_str(), &named) == 0 && fstat(file_.get(), &own) == 0 &&
                    named.st_dev == own.st_dev && named.st_ino == own.st_ino;
  return same ? numbered : "/proc/self" + file;
}

bool is_mapped(const std::string& mapping) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t at = line.find(mapping);
    if (at == std::string::npos) continue;
    const std::size_t end = at + mapping.size();
    if (end == line.size() || line[end] == ' ') return true;
  }
  return false;
}

}  // namespace mauve::plugin
