// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/durable.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/fail_point.h"

namespace mauve::daemon {

namespace {

using rt::Descriptor;
using std::filesystem::path;

constexpr mode_t kDirectoryMode = 0750;
constexpr mode_t kFileMode = 0640;

/// Only after this call the entries of a directory are on the disk.
Status sync_directory(const path& directory) {
  const Descriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd || ::fsync(fd.get()) != 0) {
    return state_not_written(directory, "bring the directory to the disk");
  }
  return ok();
}

Status write_new(const path& file, std::string_view content) {
  const Descriptor fd(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, kFileMode));
  if (!fd) {
    return state_not_written(file, "make");
  }
  if (auto written = write_all(fd.get(), content, file); !written) {
    return written;
  }
  MAUVE_FAIL_POINT("generations.after_write");
  if (::fsync(fd.get()) != 0) {
    return state_not_written(file, "bring to the disk");
  }
  MAUVE_FAIL_POINT("generations.after_fsync");
  return ok();
}

bool ends_within_a_line(int fd) {
  struct stat status {};
  char last = '\n';
  return ::fstat(fd, &status) == 0 && status.st_size > 0 &&
         ::pread(fd, &last, 1, status.st_size - 1) == 1 && last != '\n';
}

}  // namespace

Error state_not_written(const path& what, const std::string& doing) {
  const int code = errno;
  return refuse({Errc::system, "state_not_written"}, what.string(),
                "cannot " + doing + ": " + std::strerror(code),
                "free the disk, or see to its owner and mode");
}

Status write_all(int fd, std::string_view content, const path& file) {
  while (!content.empty()) {
    const auto written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      return state_not_written(file, "write");
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return ok();
}

Status make_directory(const path& directory) {
  if (::mkdir(directory.c_str(), kDirectoryMode) == 0) {
    return sync_directory(directory.has_parent_path() ? directory.parent_path() : ".");
  }
  struct stat status {};
  if (errno != EEXIST) {
    return state_not_written(directory, "make the directory");
  }
  if (::stat(directory.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) {
    return refuse({Errc::system, "state_place_unfit"}, directory.string(), "is no directory");
  }
  return ok();
}

Result<Descriptor> hold_directory(const path& directory) {
  Descriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd) {
    return state_not_written(directory, "open the directory");
  }
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) {
      return state_not_written(directory,
                               "lock the directory, so another mauved could write there");
    }
    return refuse({Errc::conflict, "state_in_use"}, directory.string(),
                  "another mauved keeps its generations here", "give each its own --state-dir");
  }
  return fd;
}

Status replace_file(const path& file, std::string_view content) {
  MAUVE_FAIL_POINT("generations.before_write");
  const path draft = file.string() + ".new";
  auto done = write_new(draft, content);
  if (done && ::rename(draft.c_str(), file.c_str()) != 0) {
    done = state_not_written(file, "put in place");
  }
  if (!done) {
    ::unlink(draft.c_str());
    return done;
  }
  MAUVE_FAIL_POINT("generations.after_rename");
  done = sync_directory(file.parent_path());
  MAUVE_FAIL_POINT("generations.after_directory_fsync");
  return done;
}

Status append_lines(const path& file, std::string_view lines) {
  const bool fresh = ::access(file.c_str(), F_OK) != 0;
  const Descriptor fd(::open(
      file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NOCTTY | O_NONBLOCK,
      kFileMode));
  if (!fd) {
    return state_not_written(file, "open");
  }
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return refuse({Errc::system, "state_place_unfit"}, file.string(), "is not a regular file",
                  "move it away");
  }
  std::string text = ends_within_a_line(fd.get()) ? "\n" : "";
  text.append(lines).append("\n");
  if (auto written = write_all(fd.get(), text, file); !written) {
    return written;
  }
  if (::fsync(fd.get()) != 0) {
    return state_not_written(file, "bring to the disk");
  }
  return fresh ? sync_directory(file.parent_path()) : ok();
}

}  // namespace mauve::daemon
