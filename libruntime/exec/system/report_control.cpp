// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/report_control.h"

#include <algorithm>
#include <utility>

#include "exec/system/prepared.h"
#include "exec/system/system.h"

#include <mauve/host/change.h>
#include <mauve/host/resource.h>

namespace mauve::exec {
namespace {

/// The verb that fits the whole edit; empty: none does.
std::string_view verb_of(const Edit& edit) {
  if (edit.mode == Mode::run) return "component.start";
  if (edit.mode == Mode::park) return "component.stop";
  if (edit.type || edit.resource) return "plugin.reload";
  if (edit.core) return "core.swap";
  if (!edit.connect.empty()) return "port.connect";
  if (!edit.disconnect.empty()) return "port.disconnect";
  if (!edit.properties.empty()) return "param.set";
  return {};
}

}  // namespace

void report_control(System& system, TraceKind kind, std::string_view name, Instant instant,
                    std::uint64_t number) {
  if (!detail::traces(TraceMode::jobs)) return;
  TraceRecord record;
  record.time = system.runner->now() - system.t0;
  record.kind = kind;
  record.thread = trace_name_id("[control]");
  record.name = trace_name_id(name);
  const bool has_instant = instant != 0;
  record.a = has_instant ? instant - system.t0 : 0;
  record.b = static_cast<std::int64_t>(number);
  system.control_trace.add(record);
}

void report_members(System& system, const PreparedChange::Content& content, std::uint64_t number) {
  for (const PreparedMember& member : content.members) {
    report_control(system, TraceKind::member, member.component->name(), 0, number);
  }
}

std::string what_of(std::string_view verb, const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 4;  // a trace keeps every text for good
  std::string text(verb);
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) {
    text += (i == 0 ? " " : ", ") + names[i];
  }
  if (names.size() > kNamed) text += " and " + std::to_string(names.size() - kNamed) + " more";
  return text;
}

std::string what_of(const Change& change) {
  std::vector<std::string> names;
  for (const Edit& edit : change.edits) names.push_back(edit.member);
  const bool only_edits = change.new_resources.empty() && change.new_components.empty() &&
                          change.remove.empty() && !names.empty();
  const std::string_view verb = only_edits ? verb_of(change.edits.front()) : "";
  const bool same = std::all_of(change.edits.begin(), change.edits.end(),
                                [&](const Edit& edit) { return verb_of(edit) == verb; });
  if (!verb.empty() && same) return what_of(verb, names);
  for (const NewResource& one : change.new_resources) names.push_back(one.resource->name());
  for (const NewComponent& one : change.new_components) names.push_back(one.component->name());
  names.insert(names.end(), change.remove.begin(), change.remove.end());
  return what_of("architecture.apply", names);
}

std::vector<std::string> set_by(const Change& change) {
  std::vector<std::string> addresses;
  for (const Edit& edit : change.edits) {
    for (const auto& property : edit.properties) {
      addresses.push_back(edit.member + "." + property.first);
    }
  }
  return addresses;
}

}  // namespace mauve::exec
