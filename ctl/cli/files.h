// SPDX-License-Identifier: LGPL-3.0-or-later
/// Files that the user names; errors are reported in the words of the system.
#pragma once

#include <fstream>
#include <functional>
#include <ostream>
#include <string>

#include "mauve/result.h"

namespace mauve::ctl {

[[nodiscard]] Result<std::ifstream> open_to_read(const std::string& path);

/// A file that is written beside its name. It takes the name at once when it is kept; a file that
/// is not kept is removed, and the file that had the name stays as it was. A device is written in
/// place.
class NewFile {
 public:
  explicit NewFile(std::string path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// Takes the name; the stream can still write. Refused when anything could not be written.
  Status keep();
  [[nodiscard]] bool kept() const { return kept_; }

 private:
  std::string path_;
  std::string beside_;
  std::ofstream stream_;
  bool kept_ = false;
};

/// The whole file, or none of it.
Status write_file(const std::string& path, const std::function<void(std::ostream&)>& write);

/// The error of the file operation that just failed, by errno.
[[nodiscard]] Error not_written(const std::string& path);

}  // namespace mauve::ctl
