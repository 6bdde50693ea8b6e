// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a task does about a core that fails, or does not prove itself.
#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "exec/safe_values.h"
#include "exec/task.h"
#include "rt/cpu_time.h"
#include "rt/fence.h"

#include <mauve/job.h>

namespace mauve::exec {
namespace {

/// In place of when a job began: nobody runs the task.
constexpr Instant kLost = -1;

/// A job that took no longer would have been in time, had it begun in time.
Instant longest_span(const TaskAttributes& task, Duration wait) {
  return (task.deadline > Duration{0} ? std::min(wait, task.deadline) : wait).count();
}

}  // namespace

/// Is, or will be, led back by the change on probation?
bool Task::leads_back() const {
  const Published* back = back_.load(std::memory_order_acquire);
  return back != nullptr && back->transaction->instant() != kClosed;
}

/// It was led back by a change that another one has overtaken, which it has not taken yet.
bool Task::gets_way_back() const {
  const Published* next = pending_.load(std::memory_order_acquire);
  return next != nullptr && next->way_back != nullptr &&
         next->transaction->state() == Transaction::State::committed;
}

/// For how long the machine may have been held up during this job: twice as long as a probe saw,
/// since a hold-up begins before the instant at which the probe was due. A job that was released
/// before such a job ended had to wait behind it, and has the same excuse.
Duration Task::excuse(Instant released, Instant end) {
  Duration held_up = 2 * held_up_since(released);
  if (held_up == Duration{0} && released < excused_until_) held_up = excused_;
  excused_ = held_up;
  excused_until_ = held_up > Duration{0} ? end : 0;
  return held_up;
}

JobTiming Task::timing_of(const JobUse& job) {
  const TaskAttributes& task = current_->bundle->task;
  const Duration excused = excuse(job.released, job.end);
  const Duration used = std::max(job.used.value_or(Duration{0}) - excused, Duration{0});
  JobTiming timing;
  timing.over_budget = task.budget > Duration{0} && used > task.budget;
  timing.late = job.late > excused;
  if (!timing.late) return timing;
  const Duration span{longest_span(task, wait_)};
  const bool took_long = Duration{job.end - job.start} > span;
  const bool waited = took_long && waits_before_ != kUnknown &&
                      rt::waits_so_far() - waits_before_ > this_job().lock_waits.count;
  timing.too_long = used > span || waited;
  return timing;
}

/// On probation a core is judged also where it does not fail.
void Task::watch_over(const JobUse& job) {
  if (const PortBase* port = this_job().implausible) {
    copy_text(fault_.text, port->name());
    return record_fault(Cause::implausible), give_up_core();
  }
  const Evidence::Rules rules{current_->tolerated, current_->window};
  const Evidence::Verdict verdict = evidence_.judge(timing_of(job), rules);
  suspected_.store(evidence_.suspicious(rules), std::memory_order_relaxed);
  if (verdict == Evidence::Verdict::none) return;
  fault_.text.fill(0);
  if (verdict == Evidence::Verdict::over_budget) {
    std::snprintf(fault_.text.data(), fault_.text.size(),
                  "job after job, the last one %lld us of %lld us",
                  static_cast<long long>(job.used.value_or(Duration{0}) / 1us),
                  static_cast<long long>(current_->bundle->task.budget / 1us));
  }
  record_fault(verdict == Evidence::Verdict::overruns ? Cause::overruns : Cause::over_budget);
  give_up_core();
}

/// `fault_` holds the text already.
void Task::record_fault(Cause cause) {
  fault_.time = clock_.now();
  fault_.cause = cause;
  fault_.job = counters_.releases.load(std::memory_order_relaxed);
  fault_.inside = thrown_out_of_;
  copy_text(fault_.core, current_->bundle->core_type.name);
  const auto& states = current_->bundle->fsm->states();
  const std::size_t index = counters_.fsm_state.load(std::memory_order_relaxed);
  copy_text(fault_.state, index < states.size() ? states[index]->name() : std::string_view());
}

/// Sets the way back off. The core goes on until its next release.
void Task::give_up_core() {
  const Published* back = back_.load(std::memory_order_acquire);
  if (back == nullptr) return;
  back->way_back->set_off(clock_, fault_, this);
}

/// A failed core waits while the way back is under way, or while its policy promises another core:
/// the relief stands by already, or [control] makes it, or says that there will be none.
bool Task::may_recover() const {
  if (leads_back() || gets_way_back()) return true;
  if (failed_.is_hopeless()) return false;
  return failed_.cause() == Cause::overruns ||
         current_->bundle->task.on_fault.action != FaultPolicy::Action::stop;
}

/// A failed core runs no more; its releases pass until something takes over.
void Task::skip_job() {
  if (!may_recover()) return park(ComponentState::faulted);
  miss(1, clock_.now());
  release_ += current_->grid.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

/// `fault_` holds the text already; the safe values are written.
void Task::on_fault(Cause cause) {
  add<std::uint64_t>(counters_.faults, 1);
  record_fault(cause);
  const Instant now = fault_.time;
  tell(TraceKind::fault, now, 0, 0, static_cast<std::uint32_t>(cause));
  rt::Event event{now, rt::EventKind::faulted, LogLevel::error, nullptr, {}, {}, {}};
  event.a = LogArgument(static_cast<std::int64_t>(cause));
  std::string_view(fault_.text.data()).copy(event.text.data(), event.text.size() - 1);
  const auto& states = current_->bundle->fsm->states();
  const std::size_t index = counters_.fsm_state.load(std::memory_order_relaxed);
  if (index < states.size()) {
    event.literal = states[index]->name().data();
    event.b = LogArgument(states[index]->name().size());
  }
  events_.push(event);
  give_up_core();
  failed_.fail(cause, clock_.now());
  if (!may_recover()) return park(ComponentState::faulted);
  wait_ = current_->grid;
  release_ += wait_.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

/// A service that does not return is ended as a job is.
void Task::write_safe_values() {
  const Bundle& bundle = *current_->bundle;
  for (const PortBase* port : bundle.shell->ports()) {
    const Binding* binding = (*bundle.bindings)[port->index()].get();
    if (binding == nullptr) continue;
    const Instant begin = clock_.now();
    watched_.keeps_thread.store(true);
    watched_.busy_since.store(begin);
    write_quietly(*port, *binding, true, watched_);
    watched_.busy_since.store(0);
    watched_.keeps_thread.store(false);
  }
}

/// The job ran into its bound.
void Task::hung() {
  std::snprintf(fault_.text.data(), fault_.text.size(), "its job ran longer than %lld ms",
                static_cast<long long>(current_->bound / 1ms));
  on_fault(Cause::hung);
}

bool Task::lose_thread(Instant since) {
  if (watched_.keeps_thread.load()) return false;
  if (!watched_.busy_since.compare_exchange_strong(since, kLost)) return false;
  // The next thread tells into a ring of its own: the lost one may be about to write.
  trace_ = new Trace{rt::TraceRing(simulated_), std::unique_ptr<Trace>(trace_.load())};
  if (Job* job = job_.exchange(nullptr)) {
    job->detached.store(true);
    rt::fence_all_threads();  // it writes alone to no exchange from here on: see LatestValue
    thrown_out_of_ = Gate::poison_and_free_all(*job);
  }
  return true;
}

/// The new core is in place, with a state that may be half written.
void Task::fail_in_hand_over(const rt::Fault& fault) {
  thrown_out_of_ = nullptr;
  write_safe_values();
  const auto text =
      std::string_view("its converter: ").copy(fault_.text.data(), fault_.text.size());
  if (fault.interrupted) {
    std::snprintf(&fault_.text.at(text), fault_.text.size() - text, "ran longer than %lld ms",
                  static_cast<long long>(current_->bound / 1ms));
  } else {
    rt::describe(fault, &fault_.text.at(text), fault_.text.size() - text);
  }
  on_fault(fault.interrupted ? Cause::hung : Cause::crashed);
}

/// A lost thread may be between two of them.
std::vector<std::shared_ptr<const Bundle>> Task::bundles() const {
  std::vector<std::shared_ptr<const Bundle>> all{current_->bundle};
  if (taking_ != nullptr) all.push_back(taking_->bundle);
  return all;
}

void Task::park_for_good(const char* why) {
  std::snprintf(fault_.text.data(), fault_.text.size(), "%s", why);
  record_fault(Cause::hung);
  park(ComponentState::faulted);
}

void Task::runs_on(Job* job) {
  job_.store(job);
  if (job != nullptr && fenced_.load()) job->detached.store(true);
}

/// Whichever thread is given to it later, too.
void Task::fence() {
  fenced_.store(true);
  if (Job* job = job_.load()) job->detached.store(true);
}

}  // namespace mauve::exec
