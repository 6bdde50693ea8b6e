// SPDX-License-Identifier: LGPL-3.0-or-later
/// Whole lines into a descriptor: a line is there as a whole, or it is not there.
#pragma once

#include <string>

#include <mauve/result.h>

#include "rt/process/descriptor.h"

namespace mauve::logging {

/// Appends `line` and a line break. A part that a full disk took is taken back, or else stays alone
/// on its line: then `torn` becomes true, and the next line begins with a line break. Waits 200 ms
/// at most for a reader of a pipe. [log]
[[nodiscard]] Status append_line(int descriptor, const std::string& target, std::string line,
                                 bool& torn);

/// A file of a log that others may rename, remove or shorten meanwhile (logrotate): the line that
/// follows goes to the file that has the name then. [log]
class RotatedFile {
 public:
  explicit RotatedFile(std::string path) : path_(std::move(path)) {}

  /// Opens the file, or makes it (0640). Never waits: a FIFO without a reader is refused.
  [[nodiscard]] Status open();
  [[nodiscard]] Status append(std::string line);

 private:
  [[nodiscard]] bool is_at_its_path() const;

  std::string path_;
  rt::Descriptor file_;
  bool torn_ = false;
};

}  // namespace mauve::logging
