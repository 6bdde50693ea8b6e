// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/health_monitor.h"

#include <unistd.h>

#include <chrono>
#include <limits>
#include <optional>
#include <utility>

#include "base/mutex.h"
#include "base/number_list.h"
#include "base/thread_role.h"
#include "commands/audit.h"
#include "commands/change/change.h"
#include "commands/look/notice.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/former.h"
#include "commands/recovery/quarantine.h"
#include "commands/recovery/unproven.h"
#include "commands/stops.h"
#include "mauve/host/architecture.h"
#include "rt/process/pulse.h"
#include "state/state_store.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

using logging::Event;

constexpr std::chrono::milliseconds kEvery{20};
constexpr unsigned kLooksANotice = 5;

std::int64_t to_signed(std::uint64_t value) { return static_cast<std::int64_t>(value); }

Event event_of(const Outcome& outcome) {
  switch (outcome.kind) {
    case Outcome::Kind::passed:
    case Outcome::Kind::overtaken:
      return Event::probation_passed;
    case Outcome::Kind::rolled_back:
      return outcome.component.empty() && outcome.reason.starts_with(kUndone) ? Event::undone
                                                                              : Event::rolled_back;
    case Outcome::Kind::fell_back:
      return Event::fell_back;
    case Outcome::Kind::stays_failed:
      return Event::stays_failed;
    case Outcome::Kind::restarted:
      break;
  }
  return Event::restarted;
}

/// "control threw: sensor lost"
std::string cause_of(const Outcome& outcome) {
  return (outcome.component.empty() ? "" : outcome.component + " ") + outcome.reason;
}

/// "generation 3", "generations 3 to 7", "generations 3 and 5".
std::string generations_of(const Outcome& outcome) {
  return outcome.generations.empty() ? "generation " + std::to_string(outcome.began)
                                     : generations_in_words(outcome.generations);
}

}  // namespace

void HealthMonitor::start(Running& running) {
  running_ = &running;
  running.report_outcomes = [this] { report_outcomes(); };
  running.settle = [this](const Outcome& outcome) { settle(outcome); };
  running.control.read([&running] { remember_cores(running); });
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::health);
    run();
  });
}

void HealthMonitor::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void HealthMonitor::run() {
  rt::Pulse pulse("health");
  MutexLock lock(mutex_);
  while (!wake_.wait_for(lock, kEvery, [this]() MAUVE_REQUIRES(mutex_) { return stopping_; })) {
    pulse.turn();
    running_->deadlines.look(*running_, std::chrono::steady_clock::now());
    if (looking_.exchange(true)) {
      continue;  // [control] is busy: one look is enough
    }
    running_->control.read([this] { look(); });
  }
}

/// [control]
void HealthMonitor::look() {
  MAUVE_ON_THREAD(control);
  report_factory();
  repeated_.report_locks(*running_);
  report_outcomes();
  if (++looks_ % kLooksANotice == 0) {
    notice_failed(*running_);
    repeated_.report_components(*running_);
  }
  look_at_places(*running_);
  look_at_unproven(*running_);
  confirm_proven(*running_);
  free_former(*running_);
  report_counted_refusals(*running_, std::chrono::steady_clock::now());
  if (running_->store != nullptr) {
    running_->disk_watch.look(running_->store->disk().busy_since(),
                              std::chrono::steady_clock::now(), running_->store->directory(),
                              running_->log);
  }
  spare_reactions(*running_);
  make_standby_cores();
  looking_ = false;
}

void HealthMonitor::report_outcomes() {
  auto retired = std::make_shared<Retired>();
  const auto outcomes = running_->deployer.tend(*retired);
  const StandStill still(*running_);  // no other outcome comes while these are reported
  running_->generation = running_->deployer.generation();
  for (auto outcome : outcomes) {
    const auto place = oldest_place(*running_);
    if (place != 0 && (outcome.oldest_open == 0 || place < outcome.oldest_open)) {
      outcome.oldest_open = place;
    }
    settle(outcome);
  }
  if (!retired->empty()) {
    running_->control.in_factory([running = running_, retired] { clean_up(*running, *retired); },
                                 [] {});
  }
}

void HealthMonitor::settle(const Outcome& outcome) {
  running_->generation = running_->deployer.generation();
  report(outcome);
  notice(*running_, outcome);
}

void HealthMonitor::report_factory() {
  for (const auto& left : running_->control.look_after_factory()) {
    running_->log.write(Event::hook_abandoned,
                        {{"hook", left.hook.empty() ? std::string("user code") : left.hook}});
  }
}

void HealthMonitor::report(const Outcome& outcome) {
  running_->counts.note(outcome);
  // Before the generation is saved: the outcome of a start says whether the stop that it ended
  // stands again.
  static_cast<void>(save_stops(*running_));
  if (outcome.kind == Outcome::Kind::rolled_back) {
    running_->supervisor.roll_back(outcome.generations, !outcome.component.empty());
    running_->rollback = outcome.generation;
  }
  const auto changes = remember_rollback(outcome);
  running_->log.write(event_of(outcome), {{"component", outcome.component},
                                          {"generation", to_signed(outcome.generation)},
                                          {"began", to_signed(outcome.began)},
                                          {"generations", generations_of(outcome)},
                                          {"cause", cause_of(outcome)},
                                          {"text", outcome.reason},
                                          {"changes", changes}});
  if (running_->store != nullptr) {
    save(outcome, changes);  // before the list of quarantine
  }
  running_->rollback_lines.forget(outcome.generations);
  const bool rolled_back = outcome.kind == Outcome::Kind::rolled_back;
  for (const auto& core : rolled_back ? outcome.cores : std::vector<std::string>()) {
    quarantine(*running_, core, outcome.reason);
  }
  let_former_go(*running_, outcome);  // last: the quarantine is of the build that failed
}

/// For `why`, and for a later undo of the same changes. Returns the differences that the rollback
/// made, in the lines of `plan`; empty of other outcomes.
std::string HealthMonitor::remember_rollback(const Outcome& outcome) {
  if (outcome.kind != Outcome::Kind::rolled_back) {
    return {};
  }
  const auto lines = running_->rollback_lines.back_from(outcome.generations);
  RollbackRecord record{outcome.generations,
                        {},
                        outcome.generation,
                        logging::utc(std::chrono::system_clock::now()),
                        cause_of(outcome)};
  for (const auto& line : lines) {
    const auto address = line["address"].get<std::string>();
    record.elements.push_back(address.substr(0, address.find('.')));
  }
  auto request = running_->rollbacks.take(outcome.generations);
  if (event_of(outcome) == Event::undone) {
    record.by = std::move(request);
  }
  running_->rollbacks.remember(std::move(record));
  return changes_of({{"lines", lines}});
}

/// The description of a generation that the system made by itself.
Generation HealthMonitor::generation_of(const Outcome& outcome, const std::string& changes) const {
  Generation about;
  about.number = outcome.generation;
  about.boot = running_->boot;
  about.time = logging::utc(std::chrono::system_clock::now());
  about.uid = geteuid();
  about.command = to_string(outcome.kind);
  about.reason = cause_of(outcome);
  about.changes = changes;
  about.builds = builds_after(*running_, outcome);
  about.mark = Confirmation::unconfirmed;
  return about;
}

/// A rollback that a user asked for is the change of that user. The audit log has a line of the
/// request.
void HealthMonitor::name_user(Generation& about, std::uint64_t undone) const {
  const auto* rollback = running_->rollbacks.of(undone);
  if (rollback == nullptr || !rollback->by) {
    return;
  }
  about.uid = rollback->by->uid;
  about.reason = rollback->by->reason;
  about.command = "change.undo";
}

/// A generation that the system made by itself is saved like others; no client waits for it.
void HealthMonitor::save(const Outcome& outcome, const std::string& changes) {
  auto& store = *running_->store;
  const auto began = outcome.began;
  account_proofs(*running_, outcome);
  if (outcome.kind == Outcome::Kind::overtaken || outcome.kind == Outcome::Kind::passed) {
    return;
  }
  const StandStill still(*running_);
  auto about = generation_of(outcome, changes);
  Json line = {{"time", about.time},         {"method", about.command},
               {"uid", about.uid},           {"pid", getpid()},
               {"reason", about.reason},     {"before", began},
               {"generation", about.number}, {"outcome", "applied"},
               {"state", about.command}};
  if (!changes.empty()) {
    line["changes"] = changes;
  }
  if (outcome.kind == Outcome::Kind::stays_failed) {
    line["outcome"] = "refused";
    return store.audit(line);  // it made no generation
  }
  const auto now = about.number;
  const bool rolled_back = outcome.kind == Outcome::Kind::rolled_back;
  if (rolled_back) {
    name_user(about, began);
    about.mark = mark_of_rollback(*running_, outcome);
  }
  if (now == running_->deployer.generation()) {
    store.keep(std::move(about), described(*running_), std::move(line), {}, StateStore::As::marked,
               now);
  } else {
    // A newer change came before this look: the architecture that runs is that of the newer
    // generation, which its own answer saves, and must not be saved as this one.
    store.audit(line);
  }
  if (rolled_back) {
    for (const auto generation : outcome.generations) {
      store.mark(generation, Confirmation::rolled_back);
    }
  }
}

/// A component that waits for a standby core that cannot be made stops waiting.
bool HealthMonitor::refused_before(const Change& standby) {
  const auto& component = standby.edits[0].member;
  if (const auto allowed = check_abandoned_in(*running_, standby); !allowed) {
    running_->deployer.refuse_standby(component, to_string(allowed.error()));
    return true;
  }
  const auto found = refused_.find(component);
  if (found == refused_.end() || found->second.generation < running_->generation) {
    return false;
  }
  running_->deployer.refuse_standby(component, found->second.why);
  return true;
}

void HealthMonitor::refuse_standby(const Change& standby, const Error& error, bool for_ever) {
  constexpr auto kAll = std::numeric_limits<std::uint64_t>::max();
  const auto& component = standby.edits[0].member;
  refused_[component] = {for_ever ? kAll : running_->generation.load(),
                         "no core stands by for it: " + to_string(error)};
  running_->log.write(Event::standby_refused,
                      {{"component", component}, {"text", to_string(error)}});
}

/// A change like any other, so that no two prepare at the same time.
void HealthMonitor::make_standby_cores() {
  if (making_ || running_->control.busy()) {
    return;
  }
  auto wanted = running_->deployer.wanted_standby_cores();
  const auto may = may_prepare(running_->control.abandoned_threads(), std::nullopt);
  if (!may) {
    for (const auto& standby : wanted) {
      running_->deployer.refuse_standby(standby.edits[0].member, to_string(may.error()));
    }
    return;
  }
  std::erase_if(wanted, [this](const Change& standby) {
    return refused_before(standby) || is_place(*running_, standby.edits[0].member);
  });
  if (wanted.empty()) {
    return;
  }
  making_ = running_->control.change([this, wanted = std::move(wanted)](Ticket ticket) {
    running_->control.works_for(std::nullopt);
    using Prepared = std::vector<Result<PreparedChange>>;
    auto prepared = std::make_shared<Prepared>();
    running_->control.in_factory(
        [this, wanted, prepared] {
          for (const auto& change : wanted) {
            prepared->push_back(running_->deployer.prepare_standby(change));
          }
        },
        [this, wanted, prepared, ticket]() mutable {
          for (std::size_t i = 0; i < wanted.size(); ++i) {
            auto& standby = (*prepared)[i];
            if (standby) {
              running_->deployer.stand_by(*standby);
            } else {
              refuse_standby(wanted[i], standby.error(), false);
            }
          }
          making_ = false;
          // A core that did not become a standby core is freed on [factory], where it was made.
          running_->control.in_factory([prepared] { prepared->clear(); }, [ticket] {});
        },
        [this, wanted](const std::string& hook) {
          for (const auto& standby : wanted) {
            refuse_standby(standby, thread_abandoned(*running_, hook, standby.edits[0].member),
                           true);
          }
          making_ = false;
        });
  });
}

}  // namespace mauve::daemon
