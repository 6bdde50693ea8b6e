// SPDX-License-Identifier: LGPL-3.0-or-later
/// The system that ran last, as the newest saved generation that can be read describes it. The mark
/// of that generation does not matter: a rollback makes a generation too, so the newest one was in
/// force at the end of the run.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "state/generations.h"

namespace mauve::daemon {

using Names = std::set<std::string, std::less<>>;

struct LastSystem {
  std::uint64_t generation = 0;  ///< 0: no generation can be read
  std::string name;              ///< of its architecture
  Names stopped;                 ///< its components that a request had stopped
};

/// [main]
[[nodiscard]] LastSystem last_system(const Generations& generations);

/// The name of the architecture in this text; empty: it cannot be read.
[[nodiscard]] std::string name_in(const std::string& text);

/// The architecture of a saved generation, with these components stopped too, in one form: two
/// architectures are the same if these texts are.
[[nodiscard]] std::string text_with_stopped(const std::string& text, const Names& stopped);

}  // namespace mauve::daemon
