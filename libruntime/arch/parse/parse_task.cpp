// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/parse_task.h"

#include <algorithm>
#include <string>

#include "arch/parse/parse_element.h"
#include "base/address.h"
#include "base/name.h"

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
      item.refuse("CPU " + std::to_string(*cpu) + " appears twice", {},
                  {Errc::duplicate, "file_says_twice"});
    } else {
      cpus.value.push_back(static_cast<int>(*cpu));
    }
  });
  if (complete && cpus.value.empty() && source.node.get_if<Node::Array>() != nullptr) {
    source.refuse("names no CPU", "leave \"cpus\" out to let the deployer choose");
  }
}

// Does it count overruns? Also when it is refused: one mistake, one problem.
bool read_on_overrun(const Source& source, TaskSpec& task) {
  // In the order of OnOverrun.
  const auto word = read_word(source, {"catch_up", "skip", "stop", "fallback"});
  if (!word) return true;
  const auto policy = static_cast<OnOverrun>(*word);
  task.on_overrun = Placed<OnOverrun>{policy, source.node.where};
  return policy == OnOverrun::stop || policy == OnOverrun::fallback;
}

constexpr std::int64_t kMostCounted = 1'000'000'000;
constexpr std::int64_t kJobsCounted = 64;  // the last ones, see TaskAttributes

void read_restart(const Source& source, FaultPolicy& policy) {
  policy.action = FaultPolicy::Action::restart;
  const auto* members = read_object(source, {{"restart",
                                              [&](const Source& value) {
                                                const auto times =
                                                    read_integer(value, 1, kMostCounted);
                                                if (times)
                                                  policy.restarts = static_cast<unsigned>(*times);
                                              }},
                                             {"per",
                                              [&](const Source& value) {
                                                if (const auto per = read_positive(value))
                                                  policy.per = *per;
                                              }},
                                             {"back_off", [&](const Source& value) {
                                                if (const auto wait = read_duration(value))
                                                  policy.back_off = *wait;
                                              }}});
  require_key(source, *members, "restart", "\"restart\": 3");
}

std::optional<FaultPolicy> read_on_fault(const Source& source) {
  FaultPolicy policy;
  if (source.node.get_if<Node::Object>() != nullptr) {
    read_restart(source, policy);
    return policy;
  }
  const std::string restart =
      "write \"on_fault\": { \"restart\": 3, \"per\": \"60s\" } to restart it";
  const auto* word = source.node.get_if<std::string>();
  if (word == nullptr) {
    source.refuse_kind("\"stop\", \"fallback\" or an object", restart);
    return std::nullopt;
  }
  if (*word == "fallback") policy.action = FaultPolicy::Action::fallback;
  if (*word == "fallback" || *word == "stop") return policy;
  const std::string near = did_you_mean(*word, {"stop", "fallback"}, "\"");
  source.refuse(
      "\"" + word->substr(0, kLongestName) + "\" is not one of stop, fallback, { \"restart\": N }",
      near.empty() ? restart : near + " Or " + restart);
  return std::nullopt;
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
  const auto limit = [](const Source& value) { return read_integer(value, 1, kJobsCounted); };
  bool counts = false;
  read_object(source,
              {{"priority", placed(task.priority, priority)},
               {"cpus", [&](const Source& value) { read_cpus(value, task.cpus); }},
               {"offset", placed(task.offset, read_duration)},
               {"deadline", placed(task.deadline, read_positive)},
               {"budget", placed(task.budget, read_positive)},
               {"stack", placed(task.stack, stack)},
               {"on_overrun", [&](const Source& value) { counts = read_on_overrun(value, task); }},
               {"overrun_limit", placed(task.overrun_limit, limit)},
               {"on_fault", placed(task.on_fault, read_on_fault)},
               {"watchdog", placed(task.watchdog, read_positive)}});
  if (task.overrun_limit && !counts) {
    source.problems.add(task.overrun_limit->where,
                        {Errc::invalid_value, "file_key_without_meaning"},
                        source.at + ".overrun_limit", "has no meaning here",
                        "it belongs to \"on_overrun\": \"stop\" and \"fallback\"");
  }
}

}  // namespace mauve::arch
