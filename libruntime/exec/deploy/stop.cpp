// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/deploy/stop.h"

#include <algorithm>
#include <map>
#include <utility>

#include "exec/commit/under_way.h"
#include "exec/deploy/shutdown.h"
#include "exec/system/report_control.h"
#include "exec/task/safe_values.h"

#include <mauve/detail/job.h>
#include <mauve/host/receipt.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve::exec {
namespace {

using Resources = std::set<const ResourceBase*>;

Resources reached(const ComponentBase& component, bool by_safe_writes) {
  Resources resources;
  for (const PortBase* port : component.shell().ports()) {
    const auto& binding = (*component.bundle()->bindings)[port->index()];
    if (binding == nullptr) continue;
    const bool wanted =
        by_safe_writes ? port->has_safe_value() : port->signature().kind == PortKind::read;
    if (wanted) resources.insert(&binding->service().resource());
  }
  return resources;
}

/// Does a stop change its state? One that is faulted is stopped too, unless no thread is left that
/// could take the order.
bool stops(const Deployed& deployed) {
  const ComponentState state = deployed.state();
  return state == ComponentState::running ||
         (state == ComponentState::faulted && deployed.task->watch().busy_since() >= 0);
}

bool shares(const Resources& a, const Resources& b) {
  return std::any_of(a.begin(), a.end(), [&](const auto* item) { return b.count(item) != 0; });
}

/// Stage of each component: later than all whose safe values it reads. Loops are cut at the number
/// of components.
std::map<const Deployed*, std::size_t> stage_numbers(const std::list<Deployed>& deployed) {
  std::vector<std::pair<const Deployed*, Resources>> writers;
  std::vector<std::pair<const Deployed*, Resources>> readers;
  for (const Deployed& one : deployed) {
    Resources written = reached(*one.component, true);
    Resources read = reached(*one.component, false);
    if (!written.empty()) writers.emplace_back(&one, std::move(written));
    if (!read.empty()) readers.emplace_back(&one, std::move(read));
  }
  std::map<const Deployed*, std::size_t> stage;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [writer, written] : writers) {
      for (const auto& [reader, read] : readers) {
        const std::size_t after = std::min(stage[writer] + 1, deployed.size());
        if (reader == writer || stage[reader] >= after || !shares(written, read)) continue;
        stage[reader] = after;
        changed = true;
      }
    }
  }
  return stage;
}

/// A component whose thread has not taken the stop by then is made safe from outside.
constexpr Duration kSafeBy = 50ms;
/// A stop waits no longer than this for a slow reader's next job.
constexpr Duration kNearRelease = 100ms;
/// It waits no longer than this for all readers together.
constexpr Duration kReadersMayTake = 500ms;

}  // namespace

Stages in_order_of_safe_values(System& system) {
  const auto numbers = stage_numbers(system.deployed);
  Stages stages(1);
  for (Deployed& deployed : system.deployed) {
    const auto found = numbers.find(&deployed);
    const bool waits = found != numbers.end() && !deployed.task->outputs().holds_any();
    const std::size_t number = waits ? found->second : 0;
    if (stages.size() <= number) stages.resize(number + 1);
    stages[number].push_back(&deployed);
  }
  return stages;
}

Result<std::shared_ptr<Ongoing>> begin_stop(System& system,
                                            const std::vector<std::string>& components,
                                            const std::optional<UserStop>& by) {
  if (Status outside = refuse_in_job("deployer", "stop()"); !outside) return outside.error();
  Stages stages(1);
  for (const std::string& name : components) {
    const Result<ComponentBase*> component = system.component(name);
    if (!component && !system.is_away(name)) return component.error();
    if (!system.up) continue;
    for (Deployed& one : system.deployed) {
      const bool meant = one.component != nullptr && one.task->name() == name;
      if (meant) stages.front().push_back(&one);  // also one that a rollback brings back
    }
  }
  for (const std::string& name : components) {
    if (by) system.stops.stop(name, *by);
  }
  system.obey_stops();
  return std::shared_ptr<Ongoing>(
      std::make_shared<Stop>(system, std::move(stages), kLongestJob, components));
}

std::shared_ptr<Ongoing> begin_stop_all(System& system, Duration bound, UserStop by) {
  system.stops.stop_all(std::move(by));
  system.obey_stops();
  return std::make_shared<Stop>(system, in_order_of_safe_values(system), patience_within(bound));
}

Stop::Stop(System& system, Stages stages, Duration patience, std::vector<std::string> names)
    : system_(system),
      under_way_(system.stops.begin(std::move(names))),
      departed_(system.departed),
      stages_(std::move(stages)),
      patience_(patience) {
  receipt_.generation = system.generation;
  begin_stage();
}

bool Stop::advance() {
  exec::advance(system_);
  if (phase_ == Phase::parking) {
    park_free();
    if (!parked()) return false;
    begin_reading();
  }
  if (phase_ == Phase::reading) {
    if (!readers_have_read() && system_.runner->now() < read_by_) return false;
    ++stage_;
    begin_stage();
    return false;
  }
  return true;
}

void Stop::begin_stage() {
  const bool last_call = stage_ == stages_.size();
  if (stage_ > stages_.size() || (last_call && waiting_.empty())) {
    phase_ = Phase::over;
    under_way_.reset();
    return;
  }
  phase_ = Phase::parking;
  safe_by_ = system_.runner->now() + kSafeBy.count();
  // A component stops to wait for the others within this time.
  patient_until_ = system_.runner->now() + (last_call ? kLongestJob : patience_).count();
  if (!last_call) {
    waiting_.insert(waiting_.end(), stages_[stage_].begin(), stages_[stage_].end());
  }
  park_free();
}

/// All that can be ordered to park now, at one instant. A change under way ends first: it is over
/// soon, or is abandoned.
void Stop::park_free() {
  auto content = std::make_unique<PreparedChange::Content>();
  std::vector<std::string> names;
  std::erase_if(waiting_, [&](Deployed* deployed) {
    if (deployed->component == nullptr) return true;  // it left
    if (deployed->changing) {
      for (const auto& commit : system_.under_way) commit->give_way(*deployed);
      return false;
    }
    deployed->task->mailbox().end_halt();  // from here on it is this stop that parks it
    if (stops(*deployed)) {
      names.push_back(deployed->component->name());
      content->members.push_back(member_of(*deployed->component, Mode::park));
      deployed->parking = true;
      deployed->ran_until_end = !system_.up;
    } else {
      deployed->task->outputs().stand();  // its orders once more
    }
    return true;
  });
  if (content->members.empty()) return;
  content->what = what_of("component.stop", names);
  content->step = !system_.up;  // the system that ends is the one that a start continues
  PreparedChange change(std::move(content));
  commits_.push_back(begin_commit(system_, change, TwoPhaseCommit::Kind::unconditional, patience_));
}

/// Is every component parked or abandoned? Later stages do not wait for a thread that hangs.
bool Stop::parked() {
  std::erase_if(commits_, [&](const std::shared_ptr<Commit>& commit) {
    if (!commit->answered()) return false;
    take_answer(*commit);
    return true;
  });
  make_safe_early();
  if (!commits_.empty()) return false;
  if (waiting_.empty()) return true;
  if (system_.runner->now() < patient_until_) return false;
  for (Deployed* deployed : waiting_) {
    deployed->ran_until_end = !system_.up && !deployed->parking;
    stop_waiting_for(*deployed);
  }
  std::erase_if(waiting_, [](const Deployed* deployed) { return deployed->parking; });
  return true;
}

void Stop::take_answer(const Commit& commit) {
  const Receipt& part = commit.receipt();
  if (commit.made() != 0 || !part.components.empty()) receipt_.state = ChangeState::applied;
  receipt_.generation = std::max(receipt_.generation, part.generation);
  made_ = std::max(made_, commit.made());
  receipt_.commit = std::max(receipt_.commit, part.commit);
  receipt_.attempts = std::max(receipt_.attempts, part.attempts);
  receipt_.components.insert(receipt_.components.end(), part.components.begin(),
                             part.components.end());
  for (Deployed* silent : commit.silent()) stop_waiting_for(*silent);
}

/// A job that is under way may write once more; its component then parks, and writes its safe
/// values itself.
void Stop::make_safe_early() {
  if (system_.runner->now() < safe_by_) return;
  for (const auto& commit : commits_) {
    for (Deployed* silent : commit->silent()) {
      if (silent->component == nullptr || !late_.insert(silent).second) continue;
      write_short_safe_values_on_behalf(*silent->component->bundle());
    }
  }
}

void Stop::stop_waiting_for(Deployed& deployed) {
  if (deployed.component == nullptr || !hung_.insert(&deployed).second) return;
  write_safe_values_on_behalf(*deployed.component->bundle());
  deployed.task->outputs().stand();
}

void Stop::begin_reading() {
  phase_ = Phase::reading;
  readers_.clear();
  read_by_ = system_.runner->now() + kReadersMayTake.count();
  const Instant soon = system_.runner->now() - system_.t0 + kNearRelease.count();
  for (std::size_t later = stage_ + 1; later < stages_.size(); ++later) {
    for (const Deployed* reader : stages_[later]) {
      const Counters& counters = reader->task->counters();
      if (counters.next_release.load() > soon) continue;
      readers_.emplace_back(reader, counters.releases.load());
    }
  }
}

/// The job that is under way may have read before; the one after it has not.
bool Stop::readers_have_read() const {
  return std::all_of(readers_.begin(), readers_.end(), [](const auto& entry) {
    const auto& [reader, before] = entry;
    return reader->state() != ComponentState::running ||
           reader->task->counters().releases.load() > before + 1;
  });
}

Result<Receipt> Stop::result() const {
  if (hung_.empty()) return receipt_;
  std::string names;
  for (const Deployed* one : hung_) {
    names += (names.empty() ? "" : ", ") + one->task->name();
  }
  return refuse(
      {Errc::partly, "stops_later"}, names,
      "did not end its job in time: its safe values are written, and it stops as soon as "
      "the job ends; all others are stopped",
      "`mauvectl doctor` names real-time threads of other programs, which may keep it from the "
      "processor; if its core never returns, restart mauved");
}

}  // namespace mauve::exec
