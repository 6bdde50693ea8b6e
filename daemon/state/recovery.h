// SPDX-License-Identifier: LGPL-3.0-or-later
/// The choice of the architecture that mauved starts: its file, or after a crash the last confirmed
/// generation of the system that ran.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "mauve/host/user_stops.h"
#include "options.h"
#include "state/last_system.h"
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
  UserStops stops = {};          ///< by users, which outlive the last run
  Names stopped = {};            ///< components that stay stopped, whatever the text says
  std::uint64_t stopped_in = 0;  ///< the generation in which they are
};

/// After a crash or an upgrade: the newest confirmed generation that is whole, whose parts all
/// exist, and whose architecture has the name of the one that ran last. A generation whose last
/// kMostCrashes runs in a row all crashed within kSoon is passed over. If there is none, the file
/// of the command line, or, when that crashed too, the generation that crashed least; the file is
/// refused if it is of another name. A run that was killed from outside did not crash. In each case
/// the components stay stopped that were stopped last. Otherwise, and with --fresh: the file. The
/// stops of users stand after each end of a run; only --fresh begins without them. A crash is
/// counted when the machine ran on. `store` may be null: nothing is kept. [main]
[[nodiscard]] Result<Origin> what_to_start(const Options& options, StateStore* store,
                                           logging::Log& log);

inline constexpr unsigned kMostCrashes = 3;
inline constexpr std::chrono::minutes kSoon{10};

}  // namespace mauve::daemon
