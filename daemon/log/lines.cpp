// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/lines.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

namespace mauve::logging {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPatience{200};

/// Waits for room, until this time at most.
bool has_room(int descriptor, Clock::time_point until) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
  pollfd room{descriptor, POLLOUT, 0};
  return left.count() > 0 && poll(&room, 1, static_cast<int>(left.count())) > 0;
}

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

/// Takes back what a failed write left behind it, unless somebody wrote there meanwhile.
bool take_back(int descriptor, off_t before, std::size_t bytes) {
  struct stat status {};
  return before >= 0 && fstat(descriptor, &status) == 0 &&
         status.st_size == before + static_cast<off_t>(bytes) && ftruncate(descriptor, before) == 0;
}

/// Of a regular file that is ours; -1: it is none.
off_t size_of(int descriptor, const LineState& state) {
  struct stat status {};
  const bool regular = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  return state.ours && regular ? status.st_size : -1;
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

Status append_line(int descriptor, const std::string& target, std::string line, LineState& state) {
  line += '\n';
  if (state.torn) {
    line.insert(line.begin(), '\n');
  }
  const off_t before = size_of(descriptor, state);
  const auto until = Clock::now() + (state.stuck ? Clock::duration{0} : kPatience);
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t written = write(descriptor, line.data() + done, line.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
      continue;
    }
    const int error = written < 0 ? errno : ENOSPC;
    if (error == EINTR || (error == EAGAIN && has_room(descriptor, until))) {
      continue;
    }
    state.stuck = true;
    state.torn = state.torn || (done > 0 && !take_back(descriptor, before, done));
    return not_written(target, "", error, how_to_mend(error));
  }
  state.torn = state.stuck = false;
  return ok();
}

Status RotatedFile::open() {
  rt::Descriptor file(::open(
      path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, 0640));
  if (!file) {
    return not_written(path_, "cannot open the log file: ", errno, how_to_mend(errno));
  }
  file_ = std::move(file);
  state_.torn = ends_within_a_line(file_.get(), path_);
  return ok();
}

Status RotatedFile::append(std::string line) {
  if (!is_at_its_path()) {
    // Where it cannot be made anew, the file goes on under its new name, if it has one.
    if (auto opened = open(); !opened && !has_a_name()) {
      return opened;
    }
  }
  return append_line(file_.get(), path_, std::move(line), state_);
}

bool RotatedFile::has_a_name() const {
  struct stat own {};
  return file_ && fstat(file_.get(), &own) == 0 && own.st_nlink > 0;
}

bool RotatedFile::is_at_its_path() const {
  struct stat named {};
  struct stat own {};
  return file_ && stat(path_.c_str(), &named) == 0 && fstat(file_.get(), &own) == 0 &&
         named.st_dev == own.st_dev && named.st_ino == own.st_ino;
}

}  // namespace mauve::logging
