// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.why: the last failure of a component, the events before it, the reaction of the
/// system, and the next step for the user.
#include <algorithm>

#include "commands/answer.h"
#include "commands/look/log_json.h"
#include "commands/look/notice.h"
#include "commands/measure/kernel_counts.h"
#include "commands/measure/more_urgent.h"
#include "commands/model.h"
#include "commands/recovery/quarantine.h"
#include "commands/stops.h"
#include "exec/update/fault_record.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/architecture.h"
#include "mauve/service.h"
#include "monitor/own_job.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

Json attempt_json(const Attempt* attempt) {
  if (attempt == nullptr) {
    return nullptr;
  }
  return {{"generation", attempt->generation},
          {"time", attempt->time},
          {"method", attempt->method},
          {"uid", attempt->uid},
          {"reason", attempt->reason}};
}

/// Of a change of the component, also of one that gave way to a rule.
Json rollback_json(const RollbackRecord* rollback) {
  if (rollback == nullptr) {
    return nullptr;
  }
  return {{"generation", rollback->generation},
          {"undone", rollback->undone},
          {"time", rollback->time},
          {"cause", rollback->cause},
          {"uid", rollback->by ? Json(rollback->by->uid) : Json()}};
}

/// Its answer may have come after the failure that it led to.
const Attempt* change_before(const Running& running, const std::string& name,
                             const Failure& failure) {
  const auto* last = running.failures.last_change(name);
  if (last != nullptr && last->generation <= failure.generation) {
    return last;
  }
  return failure.change ? &*failure.change : nullptr;
}

Json failure_json(const Running& running, const Failure& failure) {
  return {{"time", failure.time},
          {"t_ns", failure.monotonic_ns - running.deployer.t0()},
          {"ago_ns", running.deployer.clock().now() - failure.monotonic_ns},
          {"cause", failure.cause},
          {"text", failure.text},
          {"core", failure.culprit.core},
          {"build_id", failure.culprit.build_id},
          {"resource", failure.resource},
          {"fsm_state", failure.fsm_state},
          {"job", failure.job},
          {"did", to_string(failure.reaction)},
          {"core_after", failure.core_after},
          {"state_after", failure.state_after},
          {"generation", failure.generation},
          {"generation_after", failure.generation_after},
          {"times", failure.times}};
}

/// Resources that it is connected to and that refuse their users.
Json poisoned_of(const ComponentBase& component) {
  Json names = Json::array();
  for (const auto& binding : *component.bundle()->bindings) {
    if (binding == nullptr || !binding->service().resource().lock().poisoned()) {
      continue;
    }
    const Json name = binding->service().resource().name();
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

Json quarantine_of(const Running& running, const Failure* failure) {
  Json cores = Json::array();
  for (const auto& [version, reason] : running.quarantined) {
    const auto at = version.find('@');
    if (failure != nullptr && version.substr(0, at) == failure->culprit.core) {
      cores.push_back({{"core", failure->culprit.core},
                       {"build_id", version.substr(at + 1)},
                       {"reason", reason}});
    }
  }
  return cores;
}

/// "mauvectl show control: its job is ended after 75ms, which `watchdog` in the file sets"
std::string bound_in_words(const Running& running, const std::string& name) {
  const auto* component = running.architecture.find_component(name);
  const auto watchdog = component != nullptr ? component->bundle()->task.watchdog : Duration{0};
  const auto bound = running.deployer.status(name).watchdog;
  std::string reason = ", which `watchdog` in the file sets";
  if (watchdog == Duration{0}) {
    reason = ", which follows from its budget or period; `watchdog` in the file sets another time";
  } else if (bound > watchdog) {
    reason = ", since an ordinary thread has at least that time; `watchdog` in the file sets " +
             format_duration(watchdog);
  }
  return "mauvectl show " + name + ": its job is ended after " + format_duration(bound) + reason;
}

/// The next steps depend on the reaction of the system to the failure.
void add_next_steps(const Running& running, const std::string& name, const Failure& failure,
                    Json& hints) {
  const auto& core = failure.culprit.core;
  const auto cause = exec::cause_of(failure.cause);
  if (!failure.resource.empty()) {
    hints.push_back("mauvectl show " + failure.resource + ": the job failed in a call of this " +
                    "resource, so the core of " + name + " is not to blame");
  }
  switch (failure.reaction) {
    case Reaction::parked:
      if (const auto now = running.deployer.status(name); is_in_quarantine(running, now.core)) {
        hints.push_back(step_to_run(running, now));
      } else {
        hints.push_back("mauvectl start " + name + " --reset: again, with a fresh core");
      }
      hints.push_back("mauvectl plugins --for " + name +
                      ": the cores that could take its place with swap-core");
      break;
    case Reaction::fell_back:
      hints.push_back("mauvectl swap-core " + name + " " + core + ": once the core is corrected");
      break;
    case Reaction::recovers:
    case Reaction::restarted:
      hints.push_back("mauvectl show " + name + ": whether " + name + " still fails");
      break;
    case Reaction::rolled_back:
      if (!quarantine_of(running, &failure).empty()) {
        hints.push_back("mauvectl reload " + plugin_of(core) +
                        ": a corrected build; or mauvectl "
                        "quarantine release " +
                        core);
      } else {
        hints.push_back("correct what the change set, then make it again");
      }
      break;
  }
  if (cause == exec::Cause::hung) {
    hints.push_back(bound_in_words(running, name));
  }
  if (cause == exec::Cause::over_budget || cause == exec::Cause::overruns) {
    hints.push_back("mauvectl analyze: the measured and the permitted times of its jobs");
  }
  const auto* change = change_before(running, name, failure);
  const bool parked = failure.reaction == Reaction::parked;
  if (parked && change != nullptr && running.store != nullptr && change->generation > 1) {
    hints.push_back("mauvectl rollback " + std::to_string(change->generation - 1) +
                    ": back to the state before " + name + " was last changed");
  }
  if (cause) {
    hints.push_back("mauvectl explain " + std::string(exec::word_of(*cause)) +
                    ": the meaning of this failure");
  }
}

Json hints_for(const Running& running, const std::string& name, const Failure* failure,
               const Json& poisoned) {
  Json hints = Json::array();
  if (failure != nullptr) {
    add_next_steps(running, name, *failure, hints);
  }
  for (const auto& resource : poisoned) {
    const auto* element = running.architecture.find_resource(resource.get<std::string>());
    const auto type = element == nullptr ? std::string() : element->type().name;
    hints.push_back(plugin_of(type).empty()
                        ? resource.get<std::string>() + " refuses its users until mauved restarts"
                        : "mauvectl reload " + plugin_of(type) + " --state drop: a new core for " +
                              resource.get<std::string>());
  }
  return hints;
}

std::vector<logging::Record> newest_records(const Running& running, const std::string& name) {
  logging::Filter filter;
  filter.component = name;
  return running.log.history().tail(Failures::kRecords, filter);
}

/// The newest change of the component, if it came after the failure and its reaction.
const Attempt* change_after(const Running& running, const std::string& name,
                            const Failure& failure) {
  const auto* last = running.failures.last_change(name);
  const auto handled = std::max(failure.generation, failure.generation_after);
  return last != nullptr && last->generation > handled ? last : nullptr;
}

bool is_late(const ComponentStatus& status) {
  const auto last = std::max(status.elapsed_last, status.lateness_last);
  return status.late > Duration{0} || (status.period > Duration{0} && last > status.period);
}

/// Is the failure history, and the component late for another reason? A hung job of the failure
/// itself is followed by records of missed releases too, so these count after a change only.
bool late_after(const Running& running, const ComponentStatus& status, const Failure& failure) {
  if (status.state != ComponentState::running) {
    return false;
  }
  const auto* change = change_after(running, status.name, failure);
  if (change == nullptr) {
    return status.core != failure.culprit.core && is_late(status);
  }
  const auto records = newest_records(running, status.name);
  return is_late(status) || std::ranges::any_of(records, [&](const logging::Record& record) {
           return (record.event == logging::Event::missed ||
                   record.event == logging::Event::overrun) &&
                  logging::utc(record.time) > change->time;
         });
}

/// The ports that did not let out values of the present core.
Json implausible_of(const ComponentBase& component) {
  Json ports = Json::array();
  for (const auto* port : component.shell().ports()) {
    const auto count = port->implausible().of_core;
    if (count > 0) {
      ports.push_back({{"port", port->name()}, {"count", count}});
    }
  }
  return ports;
}

Json records_of(const Running& running, const std::string& name, const Failure* failure) {
  const auto records = failure != nullptr ? failure->records : newest_records(running, name);
  Json rows = Json::array();
  for (const auto& record : records) {
    rows.push_back(record_json(record, running.deployer.t0()));
  }
  return rows;
}

/// Whose first job was with the start of mauved.
std::string began(const Running& running) {
  using std::chrono::system_clock;
  const auto up = std::chrono::steady_clock::now() - running.since;
  return logging::utc(system_clock::now() - std::chrono::duration_cast<system_clock::duration>(up));
}

/// Of its own jobs, and of those that go before them.
void add_steps_of_a_late_one(const Running& running, const ComponentStatus& status, bool failed,
                             Json& hints) {
  if (status.missed + status.overruns == 0 && status.late == Duration{0}) {
    return;
  }
  auto urgent = more_urgent_hints(status, running.deployer.status());
  if (urgent.empty() && status.realtime) {
    urgent.emplace_back(
        "mauvectl doctor: the real-time threads of other programs (`foreign "
        "threads`), that with the most processor time first");
  }
  for (auto& hint : urgent) {
    hints.push_back(std::move(hint));
  }
  if (!failed && !own_job_too_long(status)) {
    hints.push_back("mauvectl stats " + status.name + ": how long its jobs take");
  }
}

}  // namespace

Result<Json> why(Running& running, const Call& call) {
  const auto name = text_or(call.params, "component");
  const auto component = find_component(running, name);
  if (!component) {
    return component.error();
  }
  notice_failed(running);
  const auto status = running.deployer.status(name);
  const auto* failure = running.failures.find(name, running.log.history());
  const auto* change = failure != nullptr ? change_before(running, name, *failure)
                                          : running.failures.last_change(name);
  const bool later = failure != nullptr && late_after(running, status, *failure);
  const auto* after = later ? change_after(running, name, *failure) : nullptr;
  const auto poisoned = poisoned_of(**component);
  const auto* stop = stop_of(running, name);
  Json result = {{"component", name},
                 {"state", to_string(status.state)},
                 {"fsm_state", status.fsm_state},
                 {"core", status.core},
                 {"recovery", recovery_json(status.recovery)},
                 {"stopped_by", stop == nullptr ? Json() : Json(in_words(*stop))},
                 {"late_ns", status.late.count()},
                 {"missed", status.missed},
                 {"overruns", status.overruns},
                 {"over_budget", status.over_present_budget},
                 {"implausible", implausible_of(**component)},
                 {"budget_ns", status.budget.count()},
                 {"elapsed_max_ns", status.elapsed_max.count()},
                 {"used_max_ns", status.used_max.count()},
                 {"kernel", kernel_counts(rt::threads_of("/", "self"), name)},
                 {"since", began(running)},
                 {"failure", failure == nullptr ? Json() : failure_json(running, *failure)},
                 {"change", attempt_json(change)},
                 {"rollback", rollback_json(running.rollbacks.last_of(name))},
                 {"poisoned", poisoned},
                 {"quarantine", quarantine_of(running, failure)},
                 {"late_after", later},
                 {"change_after", attempt_json(after)},
                 {"records", records_of(running, name, later ? nullptr : failure)},
                 {"hints", Json::array()}};
  auto& hints = result["hints"];
  if (after != nullptr && running.store != nullptr) {
    hints.push_back("mauvectl rollback " + std::to_string(after->generation - 1) +
                    ": back to the state before " + name + " was last changed");
  }
  if (later) {
    add_steps_of_a_late_one(running, status, false, hints);
  }
  for (auto& hint : hints_for(running, name, failure, poisoned)) {
    hints.push_back(std::move(hint));
  }
  if (!later) {
    add_steps_of_a_late_one(running, status, failure != nullptr, hints);
  }
  if (failure == nullptr && status.implausible_of_core > 0) {
    hints.push_back("mauvectl explain implausible_value: what readers get, and what to correct");
  }
  return result;
}

}  // namespace mauve::daemon
