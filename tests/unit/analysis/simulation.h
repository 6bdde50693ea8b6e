// SPDX-License-Identifier: LGPL-3.0-or-later
/// Random task sets, admitted by the analysis and then run on a simulated processor.
#pragma once

#include <cstdint>
#include <string>

namespace simulated {

struct Outcome {
  std::uint64_t sets = 0;
  std::uint64_t admitted = 0;
  std::uint64_t jobs = 0;
  double tightest = 0;    ///< largest response as a share of its bound
  std::string violation;  ///< of a bound; empty: none
};

/// Sets with these seeds from `seed` on until `jobs` jobs were run, or one was too late.
[[nodiscard]] Outcome simulate(std::uint64_t seed, std::uint64_t jobs);

}  // namespace simulated
