// SPDX-License-Identifier: LGPL-3.0-or-later
/// The paths that decide which system mauved starts and which users reach it: architecture file,
/// state directory and the directory of the socket. They have the trust rule of plugins
/// (plugin/load/trust.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "log/log.h"
#include "options.h"

namespace mauve::daemon {

struct DecidingPath {
  std::string what;  ///< "state directory"
  std::string path;  ///< absolute
};

/// Of these options. [main], before mauved changes its working directory
[[nodiscard]] std::vector<DecidingPath> deciding_paths(const Options& options);

/// The reason why a user other than root and the user of this process may exchange the path or its
/// content. The error names the file or directory to blame. Nothing is returned when no other user
/// may. [any but rt]
[[nodiscard]] std::optional<Error> distrust_of(const DecidingPath& deciding);

/// Writes a warning for each that is not trusted. With `Realtime::require`, as a service runs, the
/// first one is refused instead. [main]
[[nodiscard]] Status check_trust(const std::vector<DecidingPath>& paths, Realtime realtime,
                                 logging::Log& log);

}  // namespace mauve::daemon
