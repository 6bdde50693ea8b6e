// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/task_attributes.h"

#include <array>
#include <utility>
#include <vector>

#include "arch/compare/describe.h"
#include "arch/parse/parse_task.h"
#include "base/name.h"

namespace mauve::arch {
namespace {

using Reset = void (*)(TaskAttributes& task, const TaskAttributes& usual);

template <auto Member>
void reset(TaskAttributes& task, const TaskAttributes& usual) {
  task.*Member = usual.*Member;
}

constexpr std::array<std::pair<std::string_view, Reset>, 10> kAttributes{
    {{"priority", reset<&TaskAttributes::priority>},
     {"cpus", reset<&TaskAttributes::cpus>},
     {"offset", reset<&TaskAttributes::offset>},
     {"deadline", reset<&TaskAttributes::deadline>},
     {"budget", reset<&TaskAttributes::budget>},
     {"stack", reset<&TaskAttributes::stack>},
     {"on_overrun", reset<&TaskAttributes::on_overrun>},
     {"overrun_limit", reset<&TaskAttributes::overrun_limit>},
     {"on_fault", reset<&TaskAttributes::on_fault>},
     {"watchdog", reset<&TaskAttributes::watchdog>}}};

Error unknown_attribute(const std::string& at, std::string_view name) {
  std::vector<std::string> names;
  std::string list;
  for (const auto& [known, unused] : kAttributes) {
    names.emplace_back(known);
    list += (list.empty() ? "" : ", ") + names.back();
  }
  const std::string nearest = nearest_name(name, names);
  return refuse(
      {Errc::unknown_name, "unknown_attribute"}, at + "." + std::string(name),
      "a task has no attribute of this name",
      nearest.empty() ? "its attributes are " + list : "did you mean " + at + "." + nearest + "?");
}

/// The file accepts `overrun_limit` only beside `on_overrun`, so that is added.
std::string object_with(const TaskAttributes& task, const std::string& name,
                        const std::string& json) {
  const std::string beside =
      name == "overrun_limit"
          ? "\"on_overrun\": \"" + std::string(to_string(task.on_overrun)) + "\", "
          : "";
  return "{" + beside + "\"" + name + "\": " + json + "}";
}

}  // namespace

void write_attributes(const TaskSpec& spec, TaskAttributes& task) {
  if (spec.priority) task.priority = spec.priority->value;
  if (spec.cpus.where.line != 0) task.cpus = spec.cpus.value;
  if (spec.offset) task.offset = spec.offset->value;
  if (spec.deadline) task.deadline = spec.deadline->value;
  if (spec.budget) task.budget = spec.budget->value;
  if (spec.stack) task.stack = spec.stack->value;
  if (spec.on_overrun) task.on_overrun = spec.on_overrun->value;
  if (spec.overrun_limit) task.overrun_limit = spec.overrun_limit->value;
  if (spec.on_fault) task.on_fault = spec.on_fault->value;
  if (spec.watchdog) task.watchdog = spec.watchdog->value;
}

Status set_attribute(TaskAttributes& task, const std::string& at, const std::string& name,
                     const std::string& json) {
  for (const auto& [known, reset] : kAttributes) {
    if (known != name) continue;
    if (json == "null") {
      reset(task, TaskAttributes{});
      return ok();
    }
    Problems problems;
    const auto node = parse_json(object_with(task, name, json), problems);
    TaskSpec spec;
    if (node) read_task({*node, at, problems}, spec);
    if (!problems.empty()) return problems.sorted().front().error;
    write_attributes(spec, task);
    return ok();
  }
  return unknown_attribute(at, name);
}

Result<Value> attribute_of(const TaskAttributes& task, const std::string& at,
                           std::string_view name) {
  for (const auto& [known, value] : describe_task(task)) {
    if (known == name) return value;
  }
  return unknown_attribute(at, name);
}

}  // namespace mauve::arch
