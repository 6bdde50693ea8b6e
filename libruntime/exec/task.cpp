// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <string_view>

#include "exec/write_quietly.h"
#include "rt/cache.h"
#include "rt/cpu_time.h"
#include "rt/rescue.h"

#include <mauve/gate.h>
#include <mauve/job.h>

namespace mauve::exec {
namespace {

/// The ring of the task whose job this thread runs, for mauve::log().
rt::EventRing*& this_ring() {
  [[gnu::tls_model("initial-exec")]] static thread_local rt::EventRing* ring = nullptr;
  return ring;
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
  rt::touch(next.answer.get(), sizeof *next.answer);
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
  delete back_.load();
  delete relief_.load();
  static_cast<void>(reclaim());
}

void Task::begin(std::unique_ptr<Published> first, Instant t0) {
  t0_ = t0;
  current_ = first.release();
  bound_.store(current_->bound.count());
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

bool Task::release() {
  const Instant now = clock_.now();
  drop_missed(now);
  meet_boundary(now);
  if (running_ && release_ <= now) {
    if (failed_) {
      skip_job();
    } else if (!run_job(now)) {
      return false;
    }
  }
  acknowledge();
  add<std::uint64_t>(looks_, 1);
  return true;
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

void Task::take(Published& next, Instant begin) {
  acknowledge();  // of a change that is overtaken at the same boundary
  const bool was_running = running_;
  for (const auto& [port, service] : next.safe_writes) write_quietly(*port, *service);
  if (next.mode == Mode::park) write_safe_values();
  // Nothing is taken from a core that a lost thread may still be inside.
  const bool hands_over = current_->bundle->core.get() != lost_;
  if (next.into != nullptr && hands_over) {
    next.into->exchange(*next.from);
    next.answer->bytes = next.into->type().size;
  }
  if (hands_over) {
    for (const auto& [into, from] : next.observables) into->continue_from(*from);
  }
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
  bound_.store(next.bound.count(), std::memory_order_relaxed);
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

/// What user code leaves; on the stack of the job, since the task may go on without it.
struct Task::JobEnd {
  Task& task;
  FsmState* state = nullptr;  ///< the wait it ended in; null: it did not
  bool threw = false;
  std::array<char, 128> text{};

  void keep(const char* what) {
    threw = true;
    std::string_view(what).copy(text.data(), text.size() - 1);
  }
  static void run(void* self) {
    auto& end = *static_cast<JobEnd*>(self);
    try {
      end.state = end.task.run_states();
    } catch (const std::exception& error) {
      end.keep(error.what());
    } catch (...) {
      end.keep("something that is no std::exception");
    }
  }
};

bool Task::run_job(Instant now) {
  begin_job(now);
  // Invariant: whatever user code does to end its job ends here. Only this component is affected;
  // its outputs get their safe values; every resource it held was left.
  JobEnd end{*this};
  watched_.busy_since.store(now, std::memory_order_release);
  const rt::Fault fault = rt::rescued(&JobEnd::run, &end, watched_);
  if (fault.signal != 0) Gate::poison_and_leave_all();
  Instant begun = now;
  const bool ours = watched_.busy_since.compare_exchange_strong(begun, 0);
  if (ours) conclude(now, end, fault);
  Job& job = this_job();
  this_ring() = nullptr;
  job.start = 0;
  job.release = 0;
  job.running = false;
  return ours;
}

void Task::begin_job(Instant now) {
  Job& job = this_job();
  job.start = now;
  job.release = release_;
  job.running = true;
  job.implausible = nullptr;
  job.lock_bound = current_->shortest_wait;
  this_ring() = &events_;
  const Instant lateness = now - release_;
  counters_.lateness_last.store(lateness, std::memory_order_relaxed);
  raise(counters_.lateness_max, lateness);
  add<std::uint64_t>(counters_.releases, 1);
  const bool watched = back_.load(std::memory_order_relaxed) != nullptr;
  if (watched && current_->bundle->task.budget > Duration{0}) cpu_before_ = rt::cpu_time();
}

void Task::conclude(Instant start, const JobEnd& end, const rt::Fault& fault) {
  if (fault.interrupted) {
    hung();
  } else if (fault.signal != 0) {
    rt::describe(fault, fault_.data(), fault_.size());
    on_fault(Cause::crashed);
  } else if (end.threw) {
    fault_ = end.text;
    on_fault(Cause::threw);
  } else {
    state_ = end.state;
    counters_.fsm_state.store(static_cast<std::uint32_t>(state_->index()),
                              std::memory_order_relaxed);
    account(start, clock_.now());
  }
}

void Task::go_on() {
  this_job().lock_bound = current_->shortest_wait;
  this_ring() = &events_;
  lost_ = current_->bundle->core.get();
  hung();
  this_ring() = nullptr;
  watched_.busy_since.store(0);
  acknowledge();
  add<std::uint64_t>(looks_, 1);
}

/// Execution states up to the next synchronization state, which arms the next release.
FsmState* Task::run_states() {
  CoreBase& core = *current_->bundle->core;
  FsmState* state = state_ != nullptr ? &state_->next(core) : current_->bundle->fsm->initial();
  while (state->kind() == FsmState::Kind::execution) {
    counters_.fsm_state.store(static_cast<std::uint32_t>(state->index()),
                              std::memory_order_relaxed);
    state->run(core);
    if (this_job().detached.load(std::memory_order_relaxed)) break;  // given up meanwhile
    state = &state->next(core);
  }
  return state;
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

void Task::park(ComponentState state) {
  running_ = false;
  parked_at_ = clock_.now();
  counters_.state.store(state, std::memory_order_release);
  if (state == ComponentState::stopped) {
    note(rt::EventKind::stopped, LogLevel::info, clock_.now() - t0_);
  }
}

void Task::note(rt::EventKind kind, LogLevel level, std::int64_t a, std::int64_t b) {
  events_.push({clock_.now(), kind, level, nullptr, LogArgument(a), LogArgument(b), {}});
}

}  // namespace mauve::exec

namespace mauve {

void log_event(LogLevel level, const char* literal, LogArgument a, LogArgument b) {
  rt::EventRing* ring = exec::this_ring();
  if (ring == nullptr || this_job().detached.load(std::memory_order_relaxed)) return;
  ring->push({job_time(), rt::EventKind::log, level, literal, a, b, {}});
}

}  // namespace mauve
