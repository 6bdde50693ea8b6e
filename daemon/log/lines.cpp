// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/lines.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace mauve::logging {

namespace {

constexpr int kPatienceMs = 200;

Error not_written(const std::string& target, const std::string& what, int error, std::string hint) {
  return refuse({Errc::system, "log_not_written"}, target, what + std::strerror(error),
                std::move(hint));
}

std::string how_to_mend(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free the disk";
    case ENOENT:
    case ENOTDIR:
      return "name a file in an existing directory";
    case EACCES:
    case EPERM:
      return "name a file that this user may write to";
    case EROFS:
      return "name a file on a disk that may be written to";
    case ENXIO:
      return "begin the reader of the FIFO first";
    default:
      return {};
  }
}

/// Takes back what a failed write left behind it, if nobody wrote there meanwhile.
bool take_back(int descriptor, std::size_t bytes) {
  const off_t end = lseek(descriptor, 0, SEEK_CUR);
  struct stat status {};
  return end >= 0 && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
         status.st_size == end && ftruncate(descriptor, end - static_cast<off_t>(bytes)) == 0;
}

/// Of a regular file that another program, or the process before, left so.
bool ends_within_a_line(int descriptor, const std::string& path) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
    return false;
  }
  const rt::Descriptor reader(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  char last = '\n';
  return reader && pread(reader.get(), &last, 1, status.st_size - 1) == 1 && last != '\n';
}

}  // namespace

Status append_line(int descriptor, const std::string& target, std::string line, bool& torn) {
  line += '\n';
  if (torn) {
    line.insert(line.begin(), '\n');
  }
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t written = write(descriptor, line.data() + done, line.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
      continue;
    }
    const int error = written < 0 ? errno : ENOSPC;
    pollfd room{descriptor, POLLOUT, 0};
    if (error == EINTR || (error == EAGAIN && poll(&room, 1, kPatienceMs) > 0)) {
      continue;
    }
    if (done > 0 && !take_back(descriptor, done)) {
      torn = true;
    }
    return not_written(target, "", error, how_to_mend(error));
  }
  torn = false;
  return ok();
}

Status RotatedFile::open() {
  rt::Descriptor file(::open(
      path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, 0640));
  if (!file) {
    return not_written(path_, "cannot open the log file: ", errno, how_to_mend(errno));
  }
  file_ = std::move(file);
  torn_ = ends_within_a_line(file_.get(), path_);
  return ok();
}

Status RotatedFile::append(std::string line) {
  if (!is_at_its_path()) {
    if (auto opened = open(); !opened) {
      return opened;
    }
  }
  return append_line(file_.get(), path_, std::move(line), torn_);
}

bool RotatedFile::is_at_its_path() const {
  struct stat named {};
  struct stat own {};
  return file_ && stat(path_.c_str(), &named) == 0 && fstat(file_.get(), &own) == 0 &&
         named.st_dev == own.st_dev && named.st_ino == own.st_ino;
}

}  // namespace mauve::logging
