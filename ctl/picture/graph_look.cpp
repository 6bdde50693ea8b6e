// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/graph_look.h"

#include <array>

namespace mauve::ctl {
namespace {

constexpr NodeLook kRunning{"running", "#0b4a8f", "#eaf3ff", "#1f2328"};
constexpr NodeLook kResting{"resting", "#8c959f", "#eeeeee", "#57606a"};
constexpr NodeLook kFailed{"failed", kWrong, "#ffebe9", "#1f2328"};
constexpr NodeLook kResource{"resource", "#7d4e00", "#fff8e5", "#1f2328"};
constexpr std::array kNodeLooks{kRunning, kResting, kFailed, kResource};

// In the order of Flow.
constexpr std::array<FlowLook, 4> kFlowLooks{{{"#1f2328"},
                                              {kResting.line},
                                              {"#bc4c00", Stroke::dashed, "stale"},
                                              {kWrong, Stroke::dotted, "dead"}}};

}  // namespace

std::span<const NodeLook> node_looks() { return kNodeLooks; }

const NodeLook& look_of(const Graph::Node& node) {
  const bool failed = node.state == "faulted" || node.state == "recovering";
  if (failed || node.state == "poisoned") return kFailed;
  if (node.is_resource) return kResource;
  return node.state == "running" ? kRunning : kResting;
}

const FlowLook& look_of(Flow flow) { return kFlowLooks.at(static_cast<std::size_t>(flow)); }

StateLook look_of(const Machine::State& state, bool current) {
  const NodeLook& plain = state.waits ? kResource : kRunning;
  return {plain.line, current ? std::string_view("#ffdf5d") : plain.fill};
}

}  // namespace mauve::ctl
