// SPDX-License-Identifier: LGPL-3.0-or-later
/// All that the benchmark compares, the raw loop first.
#pragma once

#include <string>
#include <vector>

#include "bench/peers/peer.h"

namespace bench::peers {

struct Contender {
  std::string name;
  MakePeer make = nullptr;    ///< nullptr: mauve itself
  std::string left_out = {};  ///< why it is not measured; empty: it is
};

[[nodiscard]] std::vector<Contender> contenders();

}  // namespace bench::peers
