// SPDX-License-Identifier: LGPL-3.0-or-later
/// How the parts of graphs and machines look; the languages only spell it.
#pragma once

#include <span>
#include <string_view>

#include "picture/graph.h"
#include "picture/machine.h"

namespace mauve::ctl {

/// The colour of failed elements and of connections that lead nowhere.
inline constexpr std::string_view kWrong = "#cf222e";

struct NodeLook {
  std::string_view name;
  std::string_view line;
  std::string_view fill;
  std::string_view text;
};
[[nodiscard]] std::span<const NodeLook> node_looks();
[[nodiscard]] const NodeLook& look_of(const Graph::Node& node);

enum class Stroke { solid, dashed, dotted };

struct FlowLook {
  std::string_view line;
  Stroke stroke = Stroke::solid;
  std::string_view word = {};  ///< to be written at it
};
[[nodiscard]] const FlowLook& look_of(Flow flow);

struct StateLook {
  std::string_view line;
  std::string_view fill;
};
[[nodiscard]] StateLook look_of(const Machine::State& state, bool current);

}  // namespace mauve::ctl
