// SPDX-License-Identifier: LGPL-3.0-or-later
/// What mauved starts: its file, or after a crash what ran last.
#pragma once

#include <cstdint>
#include <string>

#include "keeper.h"
#include "options.h"

namespace mauve::daemon {

/// An architecture file and where it came from.
struct Origin {
  std::string file;
  std::string text;
  std::string folder;            ///< where its relative paths begin
  std::uint64_t generation = 0;  ///< the saved one; 0: the file of the command line
};

/// After a crash the newest confirmed generation that is whole and whose parts are all there; else,
/// and with --fresh, the file of the command line. `keeper` may be null: nothing is kept. [main]
[[nodiscard]] Result<Origin> what_to_start(const Options& options, const Keeper* keeper,
                                           logging::Log& log);

}  // namespace mauve::daemon
