// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <exception>

#include "exec/write_quietly.h"
#include "rt/cache.h"
#include "rt/cpu_time.h"

#include <mauve/job.h>
#include <mauve/request.h>

namespace mauve::exec {
namespace {

/// The task whose job this thread runs, for mauve::log() and mauve::request().
Task*& this_task() {
  [[gnu::tls_model("initial-exec")]] static thread_local Task* task = nullptr;
  return task;
}

/// Counters have one writer: a load and a store are enough.
template <typename T>
void add(std::atomic<T>& counter, T amount) {
  counter.store(counter.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
}
template <typename T>
void raise(std::atomic<T>& maximum, T value) {
  if (value > maximum.load(std::memory_order_relaxed)) {
    maximum.store(value, std::memory_order_relaxed);
  }
}

/// The first instant base + k * step that is not before `instant`.
Instant next_on_grid(Instant base, Duration step, Instant instant) {
  if (instant <= base || step <= Duration{0}) return base;
  const Instant past = instant - base;
  return base + (past + step.count() - 1) / step.count() * step.count();
}

/// The way back begins so much later, so that no member passes the instant unaware of it.
constexpr Duration kWayBackLead = 200us;

/// What take() touches was written by the coordinator, often on another CPU, from where each cache
/// line takes 100 ns. It is brought here while the old bundle is still in force.
void fetch(const Published& next, const FsmState* state) {
  rt::touch(&next, sizeof next);
  rt::touch(next.answer.get(), sizeof *next.answer);
  rt::touch(next.bundle.get(), sizeof *next.bundle);
  rt::touch(next.state_map.data(), next.state_map.size() * sizeof next.state_map[0]);
  if (state != nullptr) rt::touch(state, sizeof *state);
  next.hand_over.fetch();
  for (const auto& [into, from] : next.observables) rt::touch(into, sizeof *into);
}

}  // namespace

Task::Task(std::string name, const Clock& clock) : name_(std::move(name)), clock_(clock) {}

Task::~Task() {
  delete current_;
  delete back_.load();
  delete relief_.load();
  static_cast<void>(reclaim());
}

void Task::begin(std::unique_ptr<Published> first, Instant t0) {
  t0_ = t0;
  current_ = first.release();
  const TaskAttributes& attributes = current_->bundle->task;
  release_ = t0_ + attributes.offset.count();
  running_ = attributes.start;
  counters_.next_release.store(attributes.offset.count());
  counters_.state.store(running_ ? ComponentState::running : ComponentState::stopped);
}

bool Task::empty(std::atomic<Published*>& slot, Published& content) {
  Published* expected = &content;
  return slot.compare_exchange_strong(expected, nullptr, std::memory_order_acq_rel);
}

bool Task::stand_by(Published& relief) {
  Published* none = nullptr;
  return relief_.compare_exchange_strong(none, &relief, std::memory_order_acq_rel);
}

/// Only the task's thread adds; the coordinator takes all at once.
void Task::pile_up(Published& unused) {
  Published* top = unused_.load(std::memory_order_relaxed);
  do {
    unused.older = top;
  } while (!unused_.compare_exchange_weak(top, &unused, std::memory_order_acq_rel));
}

std::vector<std::unique_ptr<Published>> Task::reclaim() {
  std::vector<std::unique_ptr<Published>> all;
  Published* next = unused_.exchange(nullptr, std::memory_order_acquire);
  while (next != nullptr) {
    all.emplace_back(next);
    next = next->older;
  }
  return all;
}

/// Decided, and no job lies between its instant and the armed release? Whose release is due meets
/// the change at its own boundary.
bool Task::early(const Published& next) const {
  const Transaction& decision = *next.transaction;
  if (decision.state() != Transaction::State::committed || !decision.has_instant()) return false;
  return !running_ || (release_ >= decision.instant() && !due());
}

void Task::serve() {
  if (Published* next = pending_.load(std::memory_order_acquire)) {
    if (next->transaction->state() == Transaction::State::aborted) {
      give_back(*next);
    } else if (early(*next) && claim(*next)) {
      fetch(*next, state_);
      take(*next, clock_.now());
      acknowledge();
    }
  }
  if (Published* back = back_.load(std::memory_order_acquire)) {
    if (early(*back) && empty(back_, *back)) {
      take(*back, clock_.now());
      acknowledge();
    }
  }
  add<std::uint64_t>(looks_, 1);
}

void Task::release() {
  const Instant now = clock_.now();
  drop_missed(now);
  meet_boundary(now);
  if (running_ && release_ <= now) failed_ ? skip_job() : run_job(now);
  acknowledge();
  add<std::uint64_t>(looks_, 1);
}

/// Policy skip: only the newest of the releases that passed runs; the grid is kept.
void Task::drop_missed(Instant now) {
  if (current_->bundle->task.on_overrun != OnOverrun::skip) return;
  if (wait_ <= Duration{0} || now - release_ < wait_.count()) return;
  const std::int64_t dropped = (now - release_) / wait_.count();
  release_ += dropped * wait_.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  add(counters_.missed, static_cast<std::uint64_t>(dropped));
  note(rt::EventKind::missed, LogLevel::warning, dropped,
       static_cast<std::int64_t>(counters_.missed.load(std::memory_order_relaxed)));
}

/// The one place where a running component changes. Before it everything is old, after it new.
void Task::meet_boundary(Instant now) {
  Published* next = pending_.load(std::memory_order_acquire);
  if (next != nullptr && release_ >= next->transaction->instant()) {
    // The coordinator is late: a member at its instant decides for all that nothing happens.
    if (next->transaction->decide(Transaction::State::aborted) == Transaction::State::aborted) {
      give_back(*next);
    } else if (claim(*next)) {
      take(*next, now);
    }
  }
  if (Published* other = take_over()) take(*other, now);
}

/// The way back once it was set off, or the relief of a core that failed; null: go on.
Published* Task::take_over() {
  Published* back = back_.load(std::memory_order_acquire);
  if (back != nullptr && release_ >= back->transaction->instant() && empty(back_, *back)) {
    return back;
  }
  if (!failed_ || leads_back()) return nullptr;
  Published* relief = relief_.load(std::memory_order_acquire);
  const bool ready = relief != nullptr && release_ >= relief_from_ && empty(relief_, *relief);
  return ready ? relief : nullptr;
}

/// Is, or will be, led back by the change on probation?
bool Task::leads_back() const {
  const Published* back = back_.load(std::memory_order_acquire);
  return back != nullptr && back->transaction->instant() != kClosed;
}

void Task::take(Published& next, Instant begin) {
  acknowledge();  // of a change that is overtaken at the same boundary
  const bool was_running = running_;
  for (const auto& [port, service] : next.safe_writes) write_quietly(*port, *service);
  if (next.mode == Mode::park) write_safe_values();
  next.hand_over.run();
  next.answer->bytes = next.hand_over.bytes;
  for (const auto& [into, from] : next.observables) into->continue_from(*from);
  next.bundle->shell->use(next.bundle->bindings.get());
  map_state(next);
  Published* const old = current_;
  put_in_place(next);
  rearm(next, was_running);
  unacknowledged_ = &next;
  next.answer->pause = Duration{next.count_gap ? release_ - parked_at_ : clock_.now() - begin};
  pile_up(*old);
  if (running_ && was_running) {
    note(rt::EventKind::swapped, LogLevel::info, next.answer->pause.count(),
         static_cast<std::int64_t>(next.answer->bytes));
  }
}

/// What stood ready for the old bundle is of no use for another one.
void Task::put_in_place(Published& next) {
  const bool same_bundle = next.bundle == current_->bundle;
  current_ = &next;
  failed_ = false;
  if (same_bundle && next.back == nullptr) return;
  overran_ = 0;
  if (Published* before = back_.exchange(next.back.release(), std::memory_order_acq_rel)) {
    pile_up(*before);
  }
  if (Published* relief = relief_.exchange(nullptr, std::memory_order_acq_rel)) pile_up(*relief);
}

void Task::map_state(const Published& next) {
  if (next.restart) {
    state_ = nullptr;
  } else if (state_ != nullptr && !next.state_map.empty()) {
    state_ = next.state_map[state_->index()];
  }
}

/// Stops, starts, or goes on at the release that was armed before.
void Task::rearm(const Published& next, bool was_running) {
  if (next.mode == Mode::park) {
    if (was_running) park(ComponentState::stopped);
    return;
  }
  if (next.mode != Mode::run || was_running) {
    if (running_) keep_phase(next);
    return;
  }
  const Instant armed = release_;
  const Instant base = t0_ + next.bundle->task.offset.count();
  const Instant earliest = std::max(next.transaction->instant(), clock_.now());
  release_ = next_on_grid(base, next.grid, earliest);
  if (next.count_gap && next.grid > Duration{0} && release_ > armed) {
    add(counters_.missed, static_cast<std::uint64_t>((release_ - armed) / next.grid.count()));
  }
  wait_ = Duration{0};
  running_ = true;
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  counters_.state.store(ComponentState::running, std::memory_order_release);
  note(rt::EventKind::started, LogLevel::info, release_ - t0_);
}

/// Another offset moves the grid: the armed release to the first instant of the new one after it.
void Task::keep_phase(const Published& next) {
  const Instant base = t0_ + next.bundle->task.offset.count();
  if (next.offset_changes) release_ = next_on_grid(base, next.grid, release_);
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

void Task::give_back(Published& next) {
  if (!claim(next)) return;
  note(rt::EventKind::aborted, LogLevel::debug);
  next.answer->progress.store(Published::Progress::given_back, std::memory_order_release);
}

/// After the outputs of the first job with the new bundle, so that the answer costs them nothing.
void Task::acknowledge() {
  if (unacknowledged_ == nullptr) return;
  Published* const taken = std::exchange(unacknowledged_, nullptr);
  taken->answer->progress.store(Published::Progress::done, std::memory_order_release);
}

void Task::run_job(Instant now) {
  Job& job = this_job();
  job.start = now;
  job.release = release_;
  job.running = true;
  job.implausible = nullptr;
  job.lock_bound = current_->shortest_wait;
  this_task() = this;
  const Instant lateness = now - release_;
  counters_.lateness_last.store(lateness, std::memory_order_relaxed);
  raise(counters_.lateness_max, lateness);
  add<std::uint64_t>(counters_.releases, 1);
  const bool watched = back_.load(std::memory_order_relaxed) != nullptr;
  if (watched && current_->bundle->task.budget > Duration{0}) cpu_before_ = rt::cpu_time();
  // Invariant: whatever user code throws ends here. Only this component is affected; its outputs
  // get their safe values; every resource it held was left on the way (Entry).
  try {
    run_states();
    account(now, clock_.now());
  } catch (const std::exception& error) {
    on_fault(Cause::threw, error.what());
  } catch (...) {
    on_fault(Cause::threw, "something that is no std::exception");
  }
  this_task() = nullptr;
  job.start = 0;
  job.release = 0;
  job.running = false;
}

/// Execution states up to the next synchronization state, which arms the next release.
void Task::run_states() {
  CoreBase& core = *current_->bundle->core;
  FsmState* state = state_ != nullptr ? &state_->next(core) : current_->bundle->fsm->initial();
  while (state->kind() == FsmState::Kind::execution) {
    counters_.fsm_state.store(static_cast<std::uint32_t>(state->index()),
                              std::memory_order_relaxed);
    state->run(core);
    state = &state->next(core);
  }
  state_ = state;
  counters_.fsm_state.store(static_cast<std::uint32_t>(state->index()), std::memory_order_relaxed);
}

/// Advances the component's clock by the wait, and counts a job that ended too late.
void Task::account(Instant start, Instant end) {
  const TaskAttributes& task = current_->bundle->task;
  const Instant released = release_;
  wait_ = state_->duration();
  release_ = released + wait_.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  counters_.execution_last.store(end - start, std::memory_order_relaxed);
  raise(counters_.execution_max, end - start);
  if (task.budget > Duration{0} && end - start > task.budget.count()) {
    add<std::uint64_t>(counters_.over_budget, 1);
  }
  const Instant deadline =
      task.deadline > Duration{0} ? std::min(release_, released + task.deadline.count()) : release_;
  const bool late = end > deadline;
  if (late) count_overrun(task, end - deadline);
  if (this_job().implausible != nullptr) add<std::uint64_t>(counters_.implausible, 1);
  if (back_.load(std::memory_order_relaxed) != nullptr) watch_over(task, start, end, late);
}

void Task::count_overrun(const TaskAttributes& task, Instant by) {
  add<std::uint64_t>(counters_.overruns, 1);
  const std::uint64_t overruns = counters_.overruns.load(std::memory_order_relaxed);
  note(rt::EventKind::overrun, LogLevel::warning, by, static_cast<std::int64_t>(overruns));
  if (overruns < task.overrun_limit) return;
  if (task.on_overrun == OnOverrun::stop) {
    write_safe_values();
    park(ComponentState::stopped);
  } else if (task.on_overrun == OnOverrun::fallback && relief_.load() != nullptr) {
    std::snprintf(fault_.data(), fault_.size(), "overran %u times", task.overrun_limit);
    failed_ = true;  // its relief takes over at the next release
    relief_from_ = release_;
  }
}

/// On probation: what is no fault by itself leads back as well.
void Task::watch_over(const TaskAttributes& task, Instant start, Instant end, bool late) {
  overran_ = overran_ << 1U | (late ? 1U : 0U);
  const unsigned overruns = static_cast<unsigned>(std::popcount(overran_ & current_->window));
  const PortBase* port = this_job().implausible;
  if (port != nullptr) {
    std::array<char, 64> name{};
    port->name().copy(name.data(), name.size() - 1);
    give_up_core(Cause::implausible, name.data());
  } else if (overruns > current_->tolerated) {
    give_up_core(Cause::overruns, "");
  } else if (task.budget > Duration{0} && end - start > task.budget.count() &&
             rt::cpu_time() - cpu_before_ > task.budget) {
    // On the processor's clock: a job that others preempt is not to blame.
    give_up_core(Cause::over_budget, "");
  }
}

/// Sets the way back off. The core goes on until its next release.
void Task::give_up_core(Cause cause, const char* what) {
  const Published* back = back_.load(std::memory_order_acquire);
  if (back == nullptr) return;
  back->way_back->set_off(clock_.now() + kWayBackLead.count(), cause, this, what);
}

/// A failed core runs no more; its releases pass until something takes over.
void Task::skip_job() {
  if (!leads_back() && relief_.load(std::memory_order_acquire) == nullptr) {
    return park(ComponentState::faulted);
  }
  add<std::uint64_t>(counters_.missed, 1);
  release_ += current_->grid.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

void Task::park(ComponentState state) {
  running_ = false;
  parked_at_ = clock_.now();
  counters_.state.store(state, std::memory_order_release);
  if (state == ComponentState::stopped) {
    note(rt::EventKind::stopped, LogLevel::info, clock_.now() - t0_);
  }
}

void Task::on_fault(Cause cause, const char* what) {
  write_safe_values();
  add<std::uint64_t>(counters_.faults, 1);
  std::strncpy(fault_.data(), what, fault_.size() - 1);
  rt::Event event{clock_.now(), rt::EventKind::faulted, LogLevel::error, nullptr, {}, {}, {}};
  std::strncpy(event.text.data(), what, event.text.size() - 1);
  events_.push(event);
  give_up_core(cause, what);
  const Published* relief = relief_.load(std::memory_order_acquire);
  const bool relieved =
      relief != nullptr && current_->bundle->task.on_fault.action != FaultPolicy::Action::stop;
  if (!leads_back() && !relieved) return park(ComponentState::faulted);
  failed_ = true;
  wait_ = current_->grid;
  release_ += wait_.count();
  relief_from_ = relieved ? clock_.now() + relief->back_off.count() : 0;
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

void Task::write_safe_values() {
  const Bundle& bundle = *current_->bundle;
  for (const PortBase* port : bundle.shell->ports()) {
    const Binding* binding = (*bundle.bindings)[port->index()].get();
    if (binding != nullptr) write_quietly(*port, binding->service());
  }
}

void Task::note(rt::EventKind kind, LogLevel level, std::int64_t a, std::int64_t b) {
  events_.push({clock_.now(), kind, level, nullptr, LogArgument(a), LogArgument(b), {}});
}

}  // namespace mauve::exec

namespace mauve {

void log_event(LogLevel level, const char* literal, LogArgument a, LogArgument b) {
  exec::Task* task = exec::this_task();
  if (task == nullptr) return;
  task->events().push({job_time(), rt::EventKind::log, level, literal, a, b, {}});
}

bool request(std::string_view transaction) {
  exec::Task* task = exec::this_task();
  return task != nullptr && task->requests().push(job_time(), transaction);
}

}  // namespace mauve
