// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/stops/kept_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "state/durable.h"

namespace mauve::daemon {

namespace {

using rt::Descriptor;

/// Nobody has put another file in its place.
bool leads_to(const std::filesystem::path& name, const Descriptor& file) {
  struct stat at {};
  struct stat here {};
  return file && ::lstat(name.c_str(), &at) == 0 && ::fstat(file.get(), &here) == 0 &&
         S_ISREG(at.st_mode) && at.st_dev == here.st_dev && at.st_ino == here.st_ino;
}

/// A file of this name is the draft of an earlier run.
Descriptor make_anew(const std::filesystem::path& draft) {
  constexpr mode_t kMode = 0640;
  ::unlink(draft.c_str());
  return Descriptor(::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode));
}

}  // namespace

KeptFile::KeptFile(std::filesystem::path file)
    : file_(std::move(file)),
      draft_(file_.string() + ".new"),
      spare_draft_(file_.string() + ".spare") {}

bool KeptFile::is_open() const { return directory_ && leads_to(draft_, next_); }

/// The file of an earlier run is replaced by name: its owner and mode may be wrong.
Status KeptFile::open() {
  directory_ = Descriptor(::open(file_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory_) {
    return state_not_written(file_.parent_path(), "open the directory");
  }
  next_ = make_anew(draft_);
  if (!now_) {
    spare_ = make_anew(spare_draft_);
  }
  return next_ ? ok() : state_not_written(draft_, "make");
}

void KeptFile::prepare() {
  if (!is_open()) {
    static_cast<void>(open());
  }
}

Status KeptFile::replace(std::string_view content) {
  if (auto opened = is_open() ? ok() : open(); !opened) {
    return opened;
  }
  if (::ftruncate(next_.get(), 0) != 0 || ::lseek(next_.get(), 0, SEEK_SET) != 0) {
    return state_not_written(draft_, "empty");
  }
  if (auto written = write_all(next_.get(), content, draft_); !written) {
    return written;
  }
  if (::fsync(next_.get()) != 0) {
    return state_not_written(draft_, "bring to the disk");
  }
  if (auto put = put_in_place(); !put) {
    return put;
  }
  if (::fsync(directory_.get()) != 0) {
    return state_not_written(file_.parent_path(), "bring the directory to the disk");
  }
  return ok();
}

/// Exchanges the names of two files that this run has made. Where the disk cannot do that, the next
/// draft is a new file.
Status KeptFile::put_in_place() {
  if (leads_to(file_, now_) &&
      ::renameat2(AT_FDCWD, draft_.c_str(), AT_FDCWD, file_.c_str(), RENAME_EXCHANGE) == 0) {
    std::swap(now_, next_);
    return ok();
  }
  if (::rename(draft_.c_str(), file_.c_str()) != 0) {
    return state_not_written(file_, "put in place");
  }
  now_ = std::exchange(next_, std::exchange(spare_, Descriptor()));
  if (!next_ || ::rename(spare_draft_.c_str(), draft_.c_str()) != 0) {
    next_ = make_anew(draft_);
  }
  return ok();
}

}  // namespace mauve::daemon
