// SPDX-License-Identifier: LGPL-3.0-or-later
/// Where records go: a terminal, a file of JSON lines, the journal.
#pragma once

#include <filesystem>
#include <memory>

#include <mauve/result.h>

#include "log/event.h"

namespace mauve::logging {

/// One destination. Used by the [log] thread alone; may block, since no other thread waits for it.
class Sink {
 public:
  virtual ~Sink() = default;
  /// All of a record, or nothing of it: the destination is broken then (disk full). The next record
  /// is attempted all the same.
  [[nodiscard]] virtual Status write(const Record& record) = 0;
};

/// Text on stderr, coloured when that is a terminal.
[[nodiscard]] std::unique_ptr<Sink> terminal_sink();

/// JSON lines appended to a file, made if it is not there (0640), also when it was renamed or
/// removed meanwhile.
[[nodiscard]] Result<std::unique_ptr<Sink>> file_sink(const std::filesystem::path& path);

/// journald's native protocol with the fields MAUVE_EVENT, MAUVE_COMPONENT, MAUVE_<FIELD>.
[[nodiscard]] std::unique_ptr<Sink> journal_sink();

/// The socket of the journal is there. In a container or another root directory it is not.
[[nodiscard]] bool journal_answers();

/// Whether stderr is connected to a journal that answers: the process runs as a service.
[[nodiscard]] bool stderr_is_journal();

}  // namespace mauve::logging
