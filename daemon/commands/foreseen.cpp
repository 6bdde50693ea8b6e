// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/foreseen.h"

#include <utility>

#include "arch/describe.h"
#include "exec/prepared.h"

namespace mauve::daemon {

namespace {

void say(std::string kind, std::string address, Value before, Value after,
         std::vector<arch::Line>& lines) {
  if (!arch::same_value(before, after)) {
    lines.push_back(
        arch::make_line(std::move(kind), std::move(address), std::move(before), std::move(after)));
  }
}

void say_properties(const std::string& part, const Configurable& before, const Configurable& after,
                    std::vector<arch::Line>& lines) {
  for (const auto* property : after.properties()) {
    const auto* const same = before.find_property(property->name());
    say("property", part + std::string(property->name()), same == nullptr ? Value() : same->value(),
        property->value(), lines);
  }
  for (const auto* property : before.properties()) {
    if (after.find_property(property->name()) == nullptr) {
      say("property", part + std::string(property->name()), property->value(), Value(), lines);
    }
  }
}

void say_connections(const std::string& name, const Shell& shell, const Bindings& before,
                     const Bindings& after, std::vector<arch::Line>& lines) {
  for (const auto* port : shell.ports()) {
    const auto at = port->index();
    say("connection", name + ".ports." + std::string(port->name()),
        at < before.size() ? arch::describe_connection(before[at].get()) : Value(),
        at < after.size() ? arch::describe_connection(after[at].get()) : Value(), lines);
  }
}

void say_task(const std::string& name, const TaskAttributes& before, const TaskAttributes& after,
              std::vector<arch::Line>& lines) {
  const auto old = arch::describe_task(before);
  const auto now = arch::describe_task(after);
  for (std::size_t i = 0; i < now.size(); ++i) {
    say("task", name + ".task." + std::string(now[i].first), old[i].second, now[i].second, lines);
  }
}

void say_member(const exec::PreparedMember& member, std::vector<arch::Line>& lines) {
  const auto& name = member.component->name();
  const auto& before = *member.base;
  const auto& after = *member.next;
  say("core", name + ".core", before.core_type.name, after.core_type.name, lines);
  say("fsm", name + ".fsm", before.fsm_type.name, after.fsm_type.name, lines);
  say_properties(name + ".shell.", *before.shell, *after.shell, lines);
  say_properties(name + ".core.", *before.core, *after.core, lines);
  say_properties(name + ".fsm.", *before.fsm, *after.fsm, lines);
  say_connections(name, *after.shell, *before.bindings, *after.bindings, lines);
  say_task(name, before.task, after.task, lines);
  if (member.mode != Mode::keep) {
    const bool runs = member.mode == Mode::run;
    say("start", name + ".start", !runs, runs, lines);
  }
}

}  // namespace

std::vector<arch::Line> foreseen(const PreparedChange::Content& change) {
  std::vector<arch::Line> lines;
  for (const auto& member : change.members) {
    say_member(member, lines);
  }
  for (const auto& one : change.resources) {
    const auto& name = one.resource->name();
    if (one.parts.core != nullptr) {
      say_properties(name + ".core.", *one.base.core, *one.parts.core, lines);
    }
    if (one.parts.bindings != nullptr) {
      say_connections(name, one.resource->shell(), *one.base.bindings, *one.parts.bindings, lines);
    }
  }
  return lines;
}

}  // namespace mauve::daemon
