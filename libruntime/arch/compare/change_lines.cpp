// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/change_lines.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "arch/compare/describe.h"
#include "arch/parse/parts.h"
#include "base/duration.h"
#include "exec/system/prepared.h"
#include "mauve/detail/port_base.h"
#include "mauve/fsm.h"
#include "mauve/host/resource.h"
#include "mauve/property.h"

namespace mauve::arch {
namespace {

/// The values that a description of a fallback core gives; null: none.
Value values_of_fallback(const Value& fallback) {
  const Value* const values = fallback.find("properties");
  return values == nullptr ? Value() : *values;
}

class ChangeLines {
 public:
  ChangeLines(const PreparedChange::Content& change, const Runs& runs)
      : change_(change), runs_(runs) {}

  std::vector<Line> run() {
    for (const auto& joining : change_.new_resources) joins(*joining);
    for (const ResourceBase* leaving : change_.leaving_resources) leaves(*leaving);
    for (const auto& resource : change_.resources) changes(resource);
    for (const auto& member : change_.members) {
      if (member.part == exec::Part::joins) joins(*member.component);
      if (member.part == exec::Part::leaves) leaves(*member.component);
      if (member.part == exec::Part::changes) changes(member);
    }
    for (const NewFallback& fallback : change_.fallbacks) changes(fallback);
    return std::move(lines_);
  }

 private:
  void say(std::string kind, std::string address, Value before, Value after) {
    if (same_value(before, after)) return;
    lines_.push_back(
        make_line(std::move(kind), std::move(address), std::move(before), std::move(after)));
  }

  [[nodiscard]] const ResourceBase* leaving(const std::string& name) const {
    const auto found = std::ranges::find_if(change_.leaving_resources,
                                            [&](const auto* one) { return one->name() == name; });
    return found == change_.leaving_resources.end() ? nullptr : *found;
  }

  [[nodiscard]] const exec::PreparedMember* member(const std::string& name, exec::Part part) const {
    const auto found = std::ranges::find_if(change_.members, [&](const auto& one) {
      return one.part == part && one.component->name() == name;
    });
    return found == change_.members.end() ? nullptr : &*found;
  }

  void joins(const ResourceBase& resource) {
    const ResourceBase* const before = leaving(resource.name());
    const std::string title = title_of(resource);
    say("resource", resource.name(), before == nullptr ? Value() : Value(title_of(*before)), title);
    if (before == nullptr || title_of(*before) != title) return;
    const Parts old = parts_of(*before);
    const Parts next = parts_of(resource);
    for (std::size_t i = 0; i < next.size(); ++i) {
      properties(resource.name(), next[i].first, *old[i].second, *next[i].second);
    }
    ports(resource.name(), {before->shell(), before->bindings()},
          {resource.shell(), resource.bindings()});
    say("lock_budget", resource.name() + ".lock_budget", describe_lock_budget(*before),
        describe_lock_budget(resource));
  }

  void joins(const ComponentBase& component) {
    const auto* const before = member(component.name(), exec::Part::leaves);
    Value old = before == nullptr ? Value() : Value(title_of(*before->component));
    say("component", component.name(), std::move(old), title_of(component));
  }

  void leaves(const ResourceBase& resource) {
    const bool heir = std::ranges::any_of(
        change_.new_resources, [&](const auto& one) { return one->name() == resource.name(); });
    if (!heir) say("resource", resource.name(), title_of(resource), {});
  }

  void leaves(const ComponentBase& component) {
    if (member(component.name(), exec::Part::joins) != nullptr) return;
    say("component", component.name(), title_of(component), {});
  }

  void changes(const exec::PreparedResource& changed) {
    const std::string& name = changed.resource->name();
    if (changed.parts.core != nullptr) {
      properties(name, "core", *changed.base.core, *changed.parts.core);
    }
    if (changed.parts.bindings != nullptr) {
      const Shell& shell = changed.resource->shell();
      ports(name, {shell, *changed.base.bindings}, {shell, *changed.parts.bindings});
    }
    if (changed.lock_budget && *changed.lock_budget != changed.base_lock_budget) {
      const auto said = [](Duration hold) {
        return hold == Duration{0} ? Value() : Value(format_duration(hold));
      };
      say("lock_budget", name + ".lock_budget", said(changed.base_lock_budget),
          said(*changed.lock_budget));
    }
  }

  void changes(const exec::PreparedMember& changed) {
    const std::string& name = changed.component->name();
    const Bundle& before = *changed.base;
    const Bundle& after = *changed.next;
    say("core", name + ".core", before.core_type.name, after.core_type.name);
    say("fsm", name + ".fsm", before.fsm_type.name, after.fsm_type.name);
    properties(name, "shell", *before.shell, *after.shell);
    properties(name, "core", *before.core, *after.core);
    properties(name, "fsm", *before.fsm, *after.fsm);
    ports(name, {*before.shell, *before.bindings}, {*after.shell, *after.bindings});
    const auto old = describe_task(before.task);
    const auto next = describe_task(after.task);
    for (std::size_t i = 0; i < next.size(); ++i) {
      say("task", name + ".task." + std::string(next[i].first), old[i].second, next[i].second);
    }
    if (changed.mode == Mode::keep) return;
    say("start", name + ".start", runs_(*changed.component), changed.mode == Mode::run);
  }

  void changes(const NewFallback& changed) {
    const auto* const of = member(changed.component, exec::Part::changes);
    if (of == nullptr) return;
    say("fallback_core", changed.component + ".fallback_core",
        describe_fallback(of->component->fallback()), describe_fallback(changed.fallback));
  }

  /// A property that only the new element has makes a line unless it has its default.
  void properties(const std::string& name, std::string_view group, const Configurable& before,
                  const Configurable& after) {
    if (&before == &after) return;
    for (const PropertyBase* next : after.properties()) {
      if (next->type().to_value == nullptr) continue;  // no change can set it
      const PropertyBase* const old = before.find_property(next->name());
      const bool known = old != nullptr && same_type(old->type(), next->type());
      const Value value = next->value();
      if (same_value(known ? old->value() : next->default_value(), value)) continue;
      say("property", name + "." + std::string(group) + "." + std::string(next->name()),
          known ? old->value() : Value(), value);
    }
  }

  struct Wires {
    const Shell& shell;
    const Bindings& bindings;

    [[nodiscard]] Value at(std::string_view port) const {
      const PortBase* const found = shell.find_port(port);
      const bool there = found != nullptr && found->index() < bindings.size();
      return there ? describe_connection(bindings[found->index()].get()) : Value();
    }
  };

  void ports(const std::string& name, const Wires& before, const Wires& after) {
    if (&before.bindings == &after.bindings) return;
    for (const PortBase* port : after.shell.ports()) {
      say("port", name + ".ports." + std::string(port->name()), before.at(port->name()),
          after.at(port->name()));
    }
  }

  const PreparedChange::Content& change_;
  const Runs& runs_;
  std::vector<Line> lines_;
};

}  // namespace

std::vector<Line> lines_of(const PreparedChange::Content& change, const Runs& runs) {
  return ChangeLines(change, runs).run();
}

bool changes_a_property(const Line& line) {
  if (line.kind != "fallback_core") return line.kind == "property";
  return !same_value(values_of_fallback(line.before), values_of_fallback(line.after));
}

bool changes_the_topology(const Line& line) {
  return line.kind != "property" && line.kind != "start";
}

}  // namespace mauve::arch
