// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/trace.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace mauve::protocol {
namespace {

Json component_json(const TraceComponent& component) {
  Json states = Json::array();
  for (const TraceState& state : component.states) {
    states.push_back(
        {{"name", state.name}, {"kind", state.waits ? "synchronization" : "execution"}});
    if (state.waits) states.back()["wait_ns"] = state.wait;
  }
  Json json{{"name", component.name},         {"type", component.type},
            {"core", component.core},         {"initial", component.initial},
            {"priority", component.priority}, {"cpus", component.cpus},
            {"realtime", component.realtime}, {"period_ns", component.period},
            {"offset_ns", component.offset},  {"deadline_ns", component.deadline},
            {"budget_ns", component.budget},  {"states", std::move(states)}};
  if (component.change) json["change"] = *component.change;
  if (component.scheduled) json["scheduled_ns"] = *component.scheduled;
  if (component.timed) json["timed_ns"] = *component.timed;
  if (component.bound) json["bound_ns"] = *component.bound;
  if (component.measured) json["bound_measured"] = true;
  return json;
}

}  // namespace

const TraceState* TraceComponent::state(std::string_view called) const {
  const auto found = std::find_if(states.begin(), states.end(),
                                  [&](const TraceState& one) { return one.name == called; });
  return found == states.end() ? nullptr : &*found;
}

std::optional<std::int64_t> TraceComponent::cpu() const {
  if (cpus.size() != 1) return std::nullopt;
  return cpus.front();
}

Json to_json(const TraceHeader& header) {
  Json json{{"mauve_trace", kTraceFormat},
            {"mauved", header.mauved},
            {"architecture", header.architecture},
            {"boot", header.boot},
            {"t", header.written},
            {"t0_ns", header.t0},
            {"from", header.from},
            {"to", header.to},
            {"why", header.why},
            {"lost", header.lost},
            {"probe", header.probed},
            {"components", Json::array()},
            {"resources", header.resources}};
  for (const TraceComponent& component : header.components) {
    json["components"].push_back(component_json(component));
  }
  return json;
}

Json trace_record(const TraceRecord& record, std::string_view thread, std::string_view event,
                  std::string_view name) {
  Json json = Json::array({record.time, thread, event});
  const bool number = record.kind == TraceKind::user;
  const bool b = number || record.b != 0;
  if (!name.empty() || record.a != 0 || b) json.push_back(name);
  if (record.a != 0 || b) json.push_back(record.a);
  if (b) json.push_back(number ? Json(std::bit_cast<double>(record.b)) : Json(record.b));
  return json;
}

Json trace_end(std::size_t records, std::uint64_t lost) {
  return {{"end", true}, {"records", records}, {"lost", lost}};
}

}  // namespace mauve::protocol
