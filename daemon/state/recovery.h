// SPDX-License-Identifier: LGPL-3.0-or-later
/// The choice of the architecture that mauved starts: its file, or after a crash the last one that
/// ran.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "options.h"
#include "state/state_store.h"

namespace mauve::daemon {

/// An architecture file and where it came from.
struct Origin {
  std::string file;
  std::string text;
  std::string folder;            ///< where its relative paths begin
  std::uint64_t generation = 0;  ///< the saved one; 0: the file of the command line
  unsigned crashes = 0;          ///< see Generation
  std::uint64_t replaces = 0;    ///< itself a copy that an earlier recovery made; 0: it is not
};

/// After a crash or an upgrade: the newest confirmed generation that is whole and whose parts all
/// exist. A generation whose last kMostCrashes runs in a row all crashed within kSoon is passed
/// over. Otherwise, and with --fresh: the file of the command line. A crash is counted when the
/// machine ran on. `store` may be null: nothing is kept. [main]
[[nodiscard]] Result<Origin> what_to_start(const Options& options, StateStore* store,
                                           logging::Log& log);

inline constexpr unsigned kMostCrashes = 3;
inline constexpr std::chrono::minutes kSoon{10};

}  // namespace mauve::daemon
