// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task.h"

#include <algorithm>
#include <cstring>
#include <exception>

#include "exec/swap.h"
#include "rt/cache.h"

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

/// A resource that throws when it is given a safe value cannot take the machine down with it.
void write_quietly(const PortBase& port, ServiceBase& service) {
  try {
    port.write_safe(service);
  } catch (...) {
  }
}

/// The first instant base + k * step that is not before `instant`.
Instant next_on_grid(Instant base, Duration step, Instant instant) {
  if (instant <= base || step <= Duration{0}) return base;
  const Instant past = instant - base;
  return base + (past + step.count() - 1) / step.count() * step.count();
}

/// What take() touches was written by the coordinator, often on another CPU, from where each cache
/// line takes 100 ns. It is brought here while the old bundle is still in force.
void fetch(const Published& next, const FsmState* state) {
  rt::touch(&next, sizeof next);
  rt::touch(next.bundle.get(), sizeof *next.bundle);
  rt::touch(next.state_map.data(), next.state_map.size() * sizeof next.state_map[0]);
  if (state != nullptr) rt::touch(state, sizeof *state);
  if (next.into != nullptr) rt::touch(next.into, sizeof *next.into);
  if (next.from != nullptr) rt::touch(next.from, sizeof *next.from);
  for (const auto& [into, from] : next.observables) rt::touch(into, sizeof *into);
}

}  // namespace

Task::Task(std::string name, const Clock& clock) : name_(std::move(name)), clock_(clock) {}

Task::~Task() {
  delete current_;
  delete retired_.load();
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

bool Task::revoke(Published& next) {
  Published* expected = &next;
  return pending_.compare_exchange_strong(expected, nullptr, std::memory_order_acq_rel);
}

std::unique_ptr<Published> Task::reclaim() {
  return std::unique_ptr<Published>(retired_.exchange(nullptr, std::memory_order_acquire));
}

void Task::serve() {
  Published* next = pending_.load(std::memory_order_acquire);
  if (next == nullptr) return;
  switch (next->transaction->state()) {
    case Transaction::State::prepared:
      return;
    case Transaction::State::aborted:
      give_back(*next);
      return;
    case Transaction::State::committed:
      break;
  }
  if (running_ && release_ < next->transaction->instant()) return;  // jobs lie between
  if (due() || !claim(*next)) return;  // due: the job's own boundary is here
  fetch(*next, state_);
  take(*next, clock_.now());
  acknowledge();
}

void Task::release() {
  const Instant now = clock_.now();
  drop_missed(now);
  meet_boundary(now);
  if (running_) run_job(now);
  acknowledge();
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
  if (next == nullptr || release_ < next->transaction->instant()) return;
  // The coordinator is late: a member at its instant decides for all that nothing happens.
  if (next->transaction->decide(Transaction::State::aborted) == Transaction::State::aborted) {
    give_back(*next);
  } else if (claim(*next)) {
    take(*next, now);
  }
}

/// From here on the coordinator cannot take it back.
bool Task::claim(Published& next) {
  Published* expected = &next;
  return pending_.compare_exchange_strong(expected, nullptr, std::memory_order_acq_rel);
}

void Task::take(Published& next, Instant begin) {
  const bool was_running = running_;
  for (const auto& [port, service] : next.safe_writes) write_quietly(*port, *service);
  if (next.mode == Mode::park) write_safe_values();
  if (next.into != nullptr) {
    next.into->exchange(*next.from);
    next.bytes = next.into->type().size;
  }
  for (const auto& [into, from] : next.observables) into->continue_from(*from);
  next.bundle->shell->use(next.bundle->bindings.get());
  map_state(next);
  Published* const old = current_;
  current_ = &next;
  rearm(next, was_running);
  unacknowledged_ = &next;
  next.pause = Duration{next.count_gap ? release_ - parked_at_ : clock_.now() - begin};
  retired_.store(old, std::memory_order_release);
  if (running_ && was_running) {
    note(rt::EventKind::swapped, LogLevel::info, next.pause.count(),
         static_cast<std::int64_t>(next.bytes));
  }
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
  if (next.mode != Mode::run || was_running) return;
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

void Task::give_back(Published& next) {
  if (!claim(next)) return;
  note(rt::EventKind::aborted, LogLevel::debug);
  retired_.store(&next, std::memory_order_release);
  next.progress.store(Published::Progress::given_back, std::memory_order_release);
}

/// After the outputs of the first job with the new bundle, so that the answer costs them nothing.
void Task::acknowledge() {
  if (unacknowledged_ == nullptr) return;
  Published* const taken = std::exchange(unacknowledged_, nullptr);
  taken->progress.store(Published::Progress::done, std::memory_order_release);
}

void Task::run_job(Instant now) {
  Job& job = this_job();
  job.start = now;
  job.running = true;
  job.lock_bound = current_->shortest_wait;
  this_task() = this;
  const Instant lateness = now - release_;
  counters_.lateness_last.store(lateness, std::memory_order_relaxed);
  raise(counters_.lateness_max, lateness);
  add<std::uint64_t>(counters_.releases, 1);
  // Invariant: whatever user code throws ends here. Only this component is affected; its outputs
  // get their safe values; every resource it held was left on the way (Entry).
  try {
    run_states();
    account(now, clock_.now());
  } catch (const std::exception& error) {
    on_fault(error.what());
  } catch (...) {
    on_fault("something that is no std::exception");
  }
  this_task() = nullptr;
  job.start = 0;
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
  if (end <= deadline) return;
  add<std::uint64_t>(counters_.overruns, 1);
  const std::uint64_t overruns = counters_.overruns.load(std::memory_order_relaxed);
  note(rt::EventKind::overrun, LogLevel::warning, end - deadline,
       static_cast<std::int64_t>(overruns));
  if (task.on_overrun == OnOverrun::stop && overruns >= task.overrun_limit) {
    write_safe_values();
    park(ComponentState::stopped);
  }
}

void Task::park(ComponentState state) {
  running_ = false;
  parked_at_ = clock_.now();
  counters_.state.store(state, std::memory_order_release);
  if (state == ComponentState::stopped) {
    note(rt::EventKind::stopped, LogLevel::info, clock_.now() - t0_);
  }
}

void Task::on_fault(const char* what) {
  write_safe_values();
  std::strncpy(fault_.data(), what, fault_.size() - 1);
  rt::Event event{clock_.now(), rt::EventKind::faulted, LogLevel::error, nullptr, {}, {}, {}};
  std::strncpy(event.text.data(), what, event.text.size() - 1);
  events_.push(event);
  park(ComponentState::faulted);
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
