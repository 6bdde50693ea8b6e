// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace mauve::ctl {
namespace {

std::string reason() { return errno != 0 ? std::strerror(errno) : "unknown reason"; }

}  // namespace

Result<std::ifstream> open_to_read(const std::string& path) {
  std::error_code error;
  std::ifstream stream;
  // Reading a folder is the one thing at which the stream would throw.
  const bool folder = std::filesystem::is_directory(path, error);
  errno = folder ? EISDIR : 0;
  if (!folder) stream.open(path, std::ios::binary);
  if (stream.is_open()) return stream;
  return refuse({Errc::system, "file_unreadable"}, path, "the file cannot be read: " + reason());
}

NewFile::NewFile(std::string path)
    : path_(std::move(path)), beside_(path_ + "." + std::to_string(getpid()) + ".part") {
  struct stat former {};
  const bool exists = stat(path_.c_str(), &former) == 0;
  if (exists && !S_ISREG(former.st_mode)) {
    kept_ = true;
    stream_.open(path_, std::ios::binary);
    return;
  }
  // O_EXCL does not follow a link that another user has put there.
  constexpr mode_t kLessTheMask = 0666;
  const int made = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kLessTheMask);
  if (made < 0) {
    beside_.clear();
    stream_.setstate(std::ios::badbit);
    return;
  }
  if (exists) static_cast<void>(!fchmod(made, former.st_mode & 0777));
  close(made);
  stream_.open(beside_, std::ios::binary);
}

NewFile::~NewFile() {
  if (!kept_ && !beside_.empty()) std::remove(beside_.c_str());
}

Status NewFile::keep() {
  stream_ << std::flush;
  if (!stream_.good()) return not_written(path_);
  if (!kept_ && std::rename(beside_.c_str(), path_.c_str()) != 0) return not_written(path_);
  kept_ = true;
  return ok();
}

Status write_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  NewFile file(path);
  if (file.stream().good()) write(file.stream());
  return file.keep();
}

Error not_written(const std::string& path) {
  return refuse({Errc::system, "file_not_written"}, path,
                "the file cannot be written: " + reason());
}

}  // namespace mauve::ctl
