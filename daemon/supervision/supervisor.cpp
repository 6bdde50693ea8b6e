// SPDX-License-Identifier: LGPL-3.0-or-later
#include "supervision/supervisor.h"

#include <algorithm>
#include <iterator>

#include "arch/compare/diff_rules.h"
#include "arch/parse/transaction.h"
#include "base/duration.h"
#include "base/mutex.h"
#include "base/name.h"
#include "base/thread_role.h"
#include "commands/answer.h"
#include "commands/audit.h"
#include "commands/change/change.h"
#include "commands/change/stop.h"
#include "commands/lock.h"
#include "commands/look/value.h"
#include "commands/model.h"
#include "rt/process/pulse.h"
#include "supervision/rule_rows.h"
#include "supervision/transaction.h"

namespace mauve::daemon {

namespace {

using logging::Event;

constexpr std::chrono::milliseconds kLookEvery{10};
constexpr const char* kGivenSteps = "the steps given";  // "by rule loud", in "do"

/// A rule has no command line for the option that a refusal proposes to a user.
std::string hint_of(const Fault& fault) {
  return fault.hint.find("--state drop") == std::string::npos
             ? fault.hint
             : "write \"state\": \"drop\" in the step of the swap if the state may go, or give the "
               "new core a place for it";
}

std::string said(const Fault& fault) {
  const auto hint = hint_of(fault);
  return (fault.where.empty() ? "" : fault.where + ": ") + fault.message +
         (hint.empty() ? "" : " (" + hint + ")");
}

/// Locked, busy, or another change was quicker: the same may succeed a moment later.
bool is_a_matter_of_time(const Fault& fault) {
  return fault.name == to_string(Errc::conflict) || fault.name == to_string(Errc::timed_out);
}

/// For the condition of this rule.
rules::Read bound(rules::ReadFresh read, const rules::Rule& rule) {
  return [read = std::move(read), max_age = rule.max_age](const std::string& address) {
    return read(address, max_age);
  };
}

}  // namespace

void Supervisor::adopt(rules::Supervision supervision, std::uint64_t generation) {
  const auto changed = arch::changed_rules(supervision_, supervision);
  before_ = std::exchange(supervision_, std::move(supervision));
  adopted_in_ = generation;
  engine_.replace(supervision_.rules, [&changed](const rules::Rule& rule) {
    return std::ranges::find(changed, rule.name) == changed.end();
  });
  ++adoptions_;
  if (running_ != nullptr) {
    begin_to_look();
  }
}

/// At most one change on probation brings rules: another one ends the probation of the first.
void Supervisor::roll_back(const std::vector<std::uint64_t>& generations, bool failed) {
  MAUVE_ON_THREAD(control);
  for (const auto rule : makers_.forget(generations)) {
    if (!failed) {
      engine_.undone(rule);
    }
  }
  if (adopted_in_ != 0 && std::ranges::find(generations, adopted_in_) != generations.end()) {
    adopt(std::move(before_));
  }
}

std::vector<std::string> Supervisor::notes_on(const std::vector<std::uint64_t>& generations) const {
  MAUVE_ON_THREAD(control);
  const bool brings_back =
      adopted_in_ != 0 && std::ranges::find(generations, adopted_in_) != generations.end();
  const auto changed =
      brings_back ? arch::changed_rules(before_, supervision_) : std::vector<std::string>();
  auto notes = makers_.notes_on(generations, [&](rules::RuleId id) -> std::string {
    for (std::size_t i = 0; i < engine_.rules().size(); ++i) {
      const bool stays = std::ranges::find(changed, engine_.rules()[i].name) == changed.end();
      if (engine_.id(i) != id || !stays) {
        continue;
      }
      return engine_.limited(i, running_->deployer.clock().now()) > Duration{0}
                 ? "which has reached its per_hour and does not fire again until that permits it"
                 : "which fires again while its condition holds";
    }
    return {};
  });
  if (brings_back) {
    std::ranges::move(notes_on_change(before_), std::back_inserter(notes));
  }
  return notes;
}

std::vector<std::string> Supervisor::notes_on_change(const rules::Supervision& wanted) const {
  MAUVE_ON_THREAD(control);
  const auto changed = arch::changed_rules(supervision_, wanted);
  std::vector<std::string> notes;
  for (const auto& rule : wanted.rules) {
    std::string error;
    const bool begins_anew = std::ranges::find(changed, rule.name) != changed.end();
    if (!begins_anew || rule.when.evaluate(bound(reader(), rule), error) != rules::Truth::yes) {
      continue;
    }
    const auto hold = rule.timing.hold;
    notes.push_back("rule " + rule.name + " begins armed, and its condition holds now (" +
                    rules::in_words(rule.when.values(bound(reader(), rule))) +
                    "): the rule fires " +
                    (hold > Duration{0} ? "after " + format_duration(hold) : "at once"));
  }
  return notes;
}

void Supervisor::start(Running& running) {
  running_ = &running;
  begin_to_look();
}

/// Without rules there is nothing to look at, and no thread.
void Supervisor::begin_to_look() {
  if (supervision_.rules.empty() || thread_.joinable()) {
    return;
  }
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::rules);
    run();
  });
}

void Supervisor::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

/// [rules] A look that still waits is not queued twice.
void Supervisor::run() {
  rt::Pulse pulse("rules");
  MutexLock lock(mutex_);
  while (!wake_.wait_for(lock, kLookEvery, [this]() MAUVE_REQUIRES(mutex_) { return stopping_; })) {
    pulse.turn();
    if (!look_pending_.exchange(true)) {
      control_.read([this] { look(); });
    }
  }
}

/// [control]
void Supervisor::look() {
  MAUVE_ON_THREAD(control);
  look_pending_ = false;
  const auto held = [this](const rules::Rule& rule) {
    return held_by(running_->lock, steps_of(rule));
  };
  const auto fired = engine_.step(running_->deployer.clock().now(), reader(), held);
  for (const auto& change : engine_.changes()) {
    report_sight(change);
  }
  for (const auto rule : fired) {
    fire(rule);
  }
  report_blocked();
}

/// A refused rule has an event of its own at each try. A condition may come and go quickly, so a
/// rule is reported once a minute at most.
void Supervisor::report_blocked() {
  const auto now = running_->deployer.clock().now();
  for (const auto rule : engine_.blocked()) {
    const auto report = engine_.report(rule, now, reader());
    const bool may_not =
        report.state == rules::State::held || report.state == rules::State::limited;
    const auto reported = blocked_at_.find(engine_.id(rule));
    const bool lately = reported != blocked_at_.end() &&
                        now - reported->second < std::chrono::nanoseconds(1min).count();
    if (may_not && !lately) {
      blocked_at_[engine_.id(rule)] = now;
      running_->log.write(Event::rule_blocked,
                          {{"rule", engine_.rules()[rule].name}, {"text", report.why_not}});
    }
  }
}

void Supervisor::report_sight(const rules::SightChange& change) {
  logging::Fields fields = {{"address", change.address}, {"value", shown(change)}};
  if (change.lost) {
    fields.push_back({"text", consequence(engine_, change)});
  }
  running_->log.write(change.lost ? Event::value_unknown : Event::value_known, std::move(fields));
}

const rules::Steps& Supervisor::steps_of(const rules::Rule& rule) const {
  return rule.transaction.empty() ? rule.steps : *supervision_.find(rule.transaction);
}

rules::ReadFresh Supervisor::reader() const {
  return [this](const std::string& address, Duration max_age) -> Result<Value> {
    const auto quantity = arch::find_quantity(running_->architecture, address);
    if (!quantity) {
      return quantity.error();
    }
    return read(*running_, *quantity, max_age);
  };
}

void Supervisor::fire(std::size_t index) {
  const auto& rule = engine_.rules()[index];
  const auto values = rules::in_words(rule.when.values(bound(reader(), rule)));
  Dispatch dispatch{rule.transaction.empty() ? kGivenSteps : rule.transaction,
                    "by rule " + rule.name,
                    {},
                    steps_of(rule),
                    {},
                    values,
                    engine_.id(index)};
  running_->log.write(
      Event::rule_fired,
      {{"rule", rule.name},
       {"transaction", rule.transaction.empty() ? "its own steps" : rule.transaction},
       {"text", values}});
  dispatch.done = [this, id = engine_.id(index)](const std::string& answer, rules::Ended ended) {
    engine_.answered(id, answer, ended);
  };
  carry_out(std::move(dispatch));
}

void Supervisor::request(std::string component, std::string transaction) {
  MAUVE_ON_THREAD(log);
  control_.read([this, component = std::move(component), transaction = std::move(transaction)] {
    serve(component, transaction);
  });
}

/// [control] The component is real-time code of a plugin: it may request the transactions that the
/// file permits.
void Supervisor::serve(const std::string& component, const std::string& transaction) {
  MAUVE_ON_THREAD(control);
  Dispatch dispatch{transaction, "requested by " + component, component, {}, {}, {}};
  const auto* steps = supervision_.find(transaction);
  if (!supervision_.permits(component, transaction)) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : supervision_.transactions) {
      names.push_back(name);
    }
    return refuse_request(
        dispatch,
        steps == nullptr
            ? refuse({Errc::unknown_name, "unknown_transaction"}, transaction,
                     "there is no such transaction", known_names(transaction, names))
            : refuse({Errc::not_permitted, "request_not_permitted"}, component,
                     "may not request this", "name it under \"may_request\" of " + component));
  }
  if (!under_way_.emplace(component, transaction).second) {
    return refuse_request(dispatch, refuse({Errc::conflict, "transaction_under_way"}, transaction,
                                           "is under way already, by an earlier request"));
  }
  dispatch.steps = *steps;
  dispatch.done = [this, component, transaction](const std::string& /*answer*/,
                                                 rules::Ended /*ended*/) {
    under_way_.erase({component, transaction});
  };
  carry_out(std::move(dispatch));
}

void Supervisor::refuse_request(const Dispatch& dispatch, const Error& error) {
  const auto call = call_by_itself(*running_, dispatch.by);
  call->params["transaction"] = dispatch.transaction;
  call->reply = [this, &dispatch](const server::Outcome& outcome) { conclude(dispatch, outcome); };
  answer(*running_, *call, error);
}

/// [control] Queued behind the changes that wait already.
void Supervisor::carry_out(Dispatch dispatch) {
  MAUVE_ON_THREAD(control);
  auto call = call_by_itself(*running_, dispatch.by);
  const bool given = dispatch.transaction == kGivenSteps;
  call->params["transaction"] = dispatch.transaction + (given ? " " + dispatch.by : "");
  auto steps = dispatch.steps;
  if (!brings_something_new(steps)) {
    call->params["probation"] = "off";
  }
  call->on_made = [this, by = dispatch.by, rule = dispatch.rule](std::uint64_t made) {
    makers_.remember(made, {by, rule});
  };
  call->reply = [this, dispatch = std::move(dispatch),
                 asked = std::weak_ptr(call)](const server::Outcome& outcome) {
    const auto there = asked.lock();  // an answer that waited for the disk outlives it
    const bool keeps_a_thread = there != nullptr && there->keeps_a_thread;
    // Whichever thread answers, the books are kept on [control].
    control_.read(
        [this, dispatch, outcome, keeps_a_thread] { conclude(dispatch, outcome, keeps_a_thread); });
  };
  const bool stops = std::ranges::all_of(
      steps, [](const auto& step) { return step.action == rules::Action::stop; });
  auto begin = [this, call, steps](Ticket ticket) {
    const FromLookToAct still(*running_);
    call->before = running_->generation;
    if (const auto met = check_conditions(*running_, *call); !met) {
      return answer(*running_, *call, met.error());
    }
    if (ticket != nullptr) control_.works_for(std::nullopt);
    // Those that [stop] has parked meanwhile would look as if nothing was to be done.
    if (call->order != nullptr && !call->order->stopped_directly().empty()) {
      return stop_only(*running_, call, nullptr, change_that_parks(subjects_of(steps)));
    }
    begin_transaction(*running_, call, steps, std::move(ticket));
  };
  if (stops) {  // which waits for no other change
    watch_over_own_stop(*running_, call, subjects_of(steps));
    return control_.urgent([begin = std::move(begin)]() mutable { begin(nullptr); });
  }
  if (!control_.change(std::move(begin))) {
    answer(*running_, *call,
           refuse({Errc::conflict, "too_many_changes"}, "", "too many changes wait already"));
  }
}

void Supervisor::conclude(const Dispatch& dispatch, const server::Outcome& outcome,
                          bool keeps_a_thread) {
  const std::string cause = dispatch.values.empty() ? "" : " (" + dispatch.values + ")";
  logging::Fields fields = {{"transaction", dispatch.transaction}, {"by", dispatch.by + cause}};
  if (!dispatch.component.empty()) {
    fields.push_back({"component", dispatch.component});
  }
  std::string answer;
  auto ended = rules::Ended::done;
  if (const auto* fault = std::get_if<Fault>(&outcome)) {
    const bool unsafe = fault->state != "unchanged";
    fields.push_back({"text", said(*fault)});
    fields.push_back({"error", fault->name});
    fields.push_back({"id", fault->id.empty() ? fault->name : fault->id});
    running_->log.write(unsafe ? Event::transaction_unsafe : Event::transaction_refused,
                        std::move(fields));
    answer = (unsafe ? "unsafe: " : "refused: ") + said(*fault);
    // A hook that hangs would keep one more thread at each try.
    if (!unsafe && !keeps_a_thread) {
      ended = is_a_matter_of_time(*fault) ? rules::Ended::not_now : rules::Ended::refused;
    }
  } else {
    const auto& receipt = std::get<Json>(outcome);
    if (text_or(receipt, "state") != "applied") {
      makers_.rely(running_->deployer.probations(), dispatch.steps,
                   {"relied on " + dispatch.by, dispatch.rule});
    }
    answer = text_or(receipt, "state") + ", generation " + receipt["generation"].dump();
    const auto lines = changes_of(receipt);
    std::string text = answer + (lines.empty() ? "" : ": " + lines);
    // The log is all that users see of it: also that the change joined a probation.
    for (const auto& note : receipt.value("notes", Json::array())) {
      text += "; " + note.get<std::string>();
    }
    fields.push_back({"text", std::move(text)});
    running_->log.write(Event::transaction_applied, std::move(fields));
  }
  if (dispatch.done) {
    dispatch.done(answer, ended);
  }
}

Result<Json> Supervisor::list(const std::string& rule) const {
  MAUVE_ON_THREAD(control);
  const auto now = running_->deployer.clock().now();
  Json rows = Json::array();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < engine_.rules().size(); ++i) {
    names.push_back(engine_.rules()[i].name);
    if (rule.empty() || rule == names.back()) {
      rows.push_back(rule_row(engine_, i, now, running_->deployer.t0(), reader()));
    }
  }
  if (!rule.empty() && rows.empty()) {
    return refuse({Errc::unknown_name, "unknown_rule"}, rule, "there is no rule of this name",
                  known_names(rule, names));
  }
  return Json{{"items", std::move(rows)}};
}

}  // namespace mauve::daemon
