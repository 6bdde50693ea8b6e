// SPDX-License-Identifier: LGPL-3.0-or-later
/// Whole lines into a descriptor: a line is there as a whole, or it is not there.
#pragma once

#include <string>

#include <mauve/result.h>

#include "rt/process/descriptor.h"

namespace mauve::logging {

/// The state of a destination between two lines.
struct LineState {
  bool torn = false;   ///< it ends with a part of a line: the next one begins with a line break
  bool stuck = false;  ///< the last line found no room
  bool ours = false;   ///< nobody else writes to it, so a part that a full disk took is taken back
};

/// Appends `line` and a line break. To a descriptor that does not block, it waits 200 ms for room,
/// and not at all where the line before found none. [log]
[[nodiscard]] Status append_line(int descriptor, const std::string& target, std::string line,
                                 LineState& state);

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
  [[nodiscard]] bool has_a_name() const;

  std::string path_;
  rt::Descriptor file_;
  LineState state_{.ours = true};
};

}  // namespace mauve::logging
