// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

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

Status write_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  std::ofstream stream(path, std::ios::binary);
  if (stream.good()) write(stream);
  stream << std::flush;
  if (stream.good()) return ok();
  return not_written(path);
}

Error not_written(const std::string& path) {
  return refuse({Errc::system, "file_not_written"}, path,
                "the file cannot be written: " + reason());
}

}  // namespace mauve::ctl
