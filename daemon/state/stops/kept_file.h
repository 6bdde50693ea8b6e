// SPDX-License-Identifier: LGPL-3.0-or-later
/// A file that survives a power cut like those of durable.h. A process can replace it when it has
/// no free descriptor left, since the file, its draft and the directory stay open.
#pragma once

#include <filesystem>
#include <string_view>

#include "mauve/result.h"
#include "rt/process/descriptor.h"

namespace mauve::daemon {

/// Every call waits for the disk.
class KeptFile {
 public:
  explicit KeptFile(std::filesystem::path file);

  /// Opens what replace() needs, so that a later call needs no descriptor. If that fails, replace()
  /// tries it again.
  void prepare();
  /// Gives the file new content: all of it or, when this is refused, none.
  [[nodiscard]] Status replace(std::string_view content);
  [[nodiscard]] const std::filesystem::path& path() const { return file_; }

 private:
  Status open();
  [[nodiscard]] bool is_open() const;
  Status put_in_place();

  const std::filesystem::path file_;
  const std::filesystem::path draft_;
  const std::filesystem::path spare_draft_;
  rt::Descriptor directory_;
  rt::Descriptor now_;    ///< the file of that name; none before the first replace()
  rt::Descriptor next_;   ///< the draft
  rt::Descriptor spare_;  ///< the draft after the first one; none after the first replace()
};

}  // namespace mauve::daemon
