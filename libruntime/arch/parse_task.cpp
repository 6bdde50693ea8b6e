// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse_task.h"

#include <algorithm>
#include <string>

#include "arch/parse_element.h"

namespace mauve::arch {
namespace {

void read_cpus(const Source& source, Placed<std::vector<int>>& cpus) {
  cpus = {{}, source.node.where};
  bool complete = true;
  read_items(source, [&](const Source& item) {
    const auto cpu = read_integer(item, 0, kHighestCpu);
    if (!cpu) {
      complete = false;
    } else if (std::find(cpus.value.begin(), cpus.value.end(), *cpu) != cpus.value.end()) {
      item.refuse("CPU " + std::to_string(*cpu) + " appears twice", {}, Errc::duplicate);
    } else {
      cpus.value.push_back(static_cast<int>(*cpu));
    }
  });
  if (complete && cpus.value.empty() && source.node.get_if<Node::Array>() != nullptr) {
    source.refuse("names no CPU", "leave \"cpus\" out to let the deployer choose");
  }
}

std::optional<Duration> read_positive(const Source& source) {
  auto duration = read_duration(source);
  if (duration != Duration{0}) return duration;
  source.refuse("must be over 0");
  return std::nullopt;
}

// False: refused.
bool read_on_overrun(const Source& source, TaskSpec& task) {
  if (const auto* text = source.node.get_if<std::string>();
      text != nullptr && *text == "fallback") {
    refuse_unsupported(source, "\"fallback\"", "use catch_up, skip or stop");
    return false;
  }
  const auto word = read_word(source, {"catch_up", "skip", "stop"});  // in the order of OnOverrun
  if (word) task.on_overrun = Placed<OnOverrun>{static_cast<OnOverrun>(*word), source.node.where};
  return word.has_value();
}

}  // namespace

void read_task(const Source& source, TaskSpec& task) {
  task.where = source.node.where;
  const auto priority = [](const Source& value) {
    return read_integer(value, kLowestPriority, kHighestPriority);
  };
  const auto stack = [](const Source& value) {
    return read_size(value, kSmallestStack, kLargestStack);
  };
  const auto limit = [](const Source& value) { return read_integer(value, 1, 1'000'000'000); };
  bool may_stop = false;  // also when the policy is refused: one mistake, one problem
  read_object(source, {{"priority", placed(task.priority, priority)},
                       {"cpus", [&](const Source& value) { read_cpus(value, task.cpus); }},
                       {"offset", placed(task.offset, read_duration)},
                       {"deadline", placed(task.deadline, read_positive)},
                       {"budget", placed(task.budget, read_positive)},
                       {"stack", placed(task.stack, stack)},
                       {"on_overrun",
                        [&](const Source& value) {
                          may_stop = !read_on_overrun(value, task) ||
                                     task.on_overrun->value == OnOverrun::stop;
                        }},
                       {"overrun_limit", placed(task.overrun_limit, limit)}});
  if (task.overrun_limit && !may_stop) {
    source.problems.add(task.overrun_limit->where, Errc::invalid_value,
                        source.at + ".overrun_limit", "has no meaning here",
                        "it belongs to \"on_overrun\": \"stop\"");
  }
}

}  // namespace mauve::arch
