// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/task.h"

#include <algorithm>

#include "exec/task/nearby.h"
#include "exec/task/safe_values.h"
#include "exec/task/write_quietly.h"
#include "rt/cache.h"
#include "rt/preemption.h"

#include <mauve/fsm.h>
#include <mauve/observable.h>
#include <mauve/state.h>
#include <mauve/task_attributes.h>

namespace mauve::exec {
namespace {

/// A change that neither replaces the core nor starts or stops the component leaves a failed core
/// failed. A change on probation forgets the failure: it is judged by the jobs that follow.
bool keeps_core(const Published& next, const Published& current) {
  if (next.mode != Mode::keep || next.taken_as != TakenAs::change) return false;
  return next.mode_only || (next.back == nullptr && next.bundle->core == current.bundle->core);
}

/// The first instant base + k * step that is not before `instant`.
Instant next_on_grid(Instant base, Duration step, Instant instant) {
  if (instant <= base || step <= Duration{0}) return base;
  return base + (instant - base + step.count() - 1) / step.count() * step.count();
}

}  // namespace

/// What take() touches was written by the coordinator, often on another CPU, from where each cache
/// line takes 100 ns, or was not used since the last job. It is brought here while the old bundle
/// is still in force.
void Task::fetch(const Published& next) {
  if (next.barrier != Published::Barrier::none) return;
  rt::ask_for(&back_, sizeof back_ + sizeof relief_);  // others write them too
  trace().ring.fetch();
  rt::touch(&next, sizeof next);
  rt::touch(next.answer.get(), sizeof *next.answer);
  rt::touch(next.bundle.get(), sizeof *next.bundle);
  rt::touch(next.bundle->measured.get(), sizeof *next.bundle->measured);
  rt::touch(next.state_map.data(), next.state_map.size() * sizeof next.state_map[0]);
  if (state_ != nullptr) rt::touch(state_, sizeof *state_);
  if (current_->bundle->core.get() != lost_) next.hand_over.fetch();
  for (const auto& [into, from] : next.observables) rt::touch(into, sizeof *into);
  rt::touch(next.bundle->shell.get(), sizeof *next.bundle->shell);
  rt::touch(current_, sizeof *current_);
  rt::touch(current_->bundle.get(), sizeof *current_->bundle);
  rt::touch(&counters_, sizeof counters_);
  rt::touch(&bound_, sizeof bound_);
  const auto* const own = reinterpret_cast<const std::byte*>(&current_);
  rt::touch(own, static_cast<std::size_t>(reinterpret_cast<const std::byte*>(this + 1) - own));
  rt::touch_swap_code();
}

Task::Task(std::string name, const Clock& clock, std::shared_ptr<const rt::Noise> noise)
    : name_(std::move(name)),
      trace_name_(trace_name_id(name_)),
      clock_(clock),
      simulated_(dynamic_cast<const MonotonicClock*>(&clock) == nullptr ? &clock : nullptr),
      noise_(std::move(noise)),
      trace_(new Trace{rt::TraceRing(simulated_), nullptr}) {
  static_cast<void>(rt::preemption_is_told());  // It finds that out in its first call, and sleeps.
}

Task::~Task() {
  delete trace_.load();
  delete current_;
  delete back_.load();
  delete relief_.load();
  static_cast<void>(reclaim());
}

void Task::begin(std::unique_ptr<Published> first, Instant t0) {
  t0_ = t0;
  current_ = first.release();
  bound_.store(current_->bound.count());
  has_safe_values_.store(current_->has_safe_values);
  const TaskAttributes& attributes = current_->bundle->task;
  release_ = t0_ + attributes.offset.count();
  running_ = attributes.start && current_->mode != Mode::park;
  counters_.next_release.store(attributes.offset.count());
  counters_.state.store(running_ ? ComponentState::running : ComponentState::stopped);
  if (running_) tell(TraceKind::started, clock_.now(), release_ - t0_);
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

bool Task::serve() {
  if (Published* next = pending_.load(std::memory_order_acquire)) {
    if (next->transaction->state() == Transaction::State::aborted) {
      give_back(*next);
    } else if (early(*next) && claim(*next)) {
      fetch(*next);
      if (!take(*next, state_time())) return false;
      answer_between_jobs();
    }
  }
  if (Published* back = back_.load(std::memory_order_acquire)) {
    if (early(*back) && empty(back_, *back)) {
      if (!take(*back, clock_.now())) return false;
      answer_between_jobs();
    }
  }
  if (halted() && (running_ || waiting_)) stand_still();
  if (failed_ && running_ && !may_recover()) park(ComponentState::faulted);
  looked();
  return true;
}

bool Task::release() {
  if (current_->nearby != nullptr) current_->nearby->ask();
  const Instant now = clock_.now();
  drop_missed(now);
  if (!meet_boundary(now)) return false;
  if (running_ && release_ <= now) {
    if (failed_) {
      skip_job();
    } else if (!run_job(now)) {
      return false;
    }
  }
  acknowledge();
  looked();
  return true;
}

/// Policy skip: only the newest of the releases that passed runs; the grid is kept.
void Task::drop_missed(Instant now) {
  if (current_->bundle->task.on_overrun != OnOverrun::skip) return;
  if (wait_ <= Duration{0} || now - release_ < wait_.count()) return;
  const std::int64_t dropped = (now - release_) / wait_.count();
  release_ += dropped * wait_.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  miss(static_cast<std::uint64_t>(dropped), now);
  note(rt::EventKind::missed, LogLevel::warning, dropped,
       static_cast<std::int64_t>(counters_.missed.load(std::memory_order_relaxed)));
}

/// The one place where a running component changes. Before it everything is old, after it new.
bool Task::meet_boundary(Instant now) {
  Published* next = pending_.load(std::memory_order_acquire);
  if (next != nullptr) {
    // The coordinator is late: a member at its instant decides for all that nothing happens.
    const Transaction::Verdict verdict = next->transaction->meet(release_);
    if (verdict == Transaction::Verdict::give_back) give_back(*next);
    const bool takes = verdict == Transaction::Verdict::take && claim(*next);
    if (takes && !take(*next, now)) return false;
  }
  if (waiting_) return true;  // a relief waits as well
  Published* const other = take_over();
  return other == nullptr || take(*other, now);
}

/// The way back once it was set off, or the relief of a core that failed; null: go on.
Published* Task::take_over() {
  Published* back = back_.load(std::memory_order_acquire);
  const bool goes_back =
      back != nullptr && back->transaction->meet(release_) == Transaction::Verdict::take;
  if (goes_back && empty(back_, *back)) return back;
  if (!failed_ || leads_back() || failed_.is_hopeless()) return nullptr;
  Published* relief = relief_.load(std::memory_order_acquire);
  if (relief == nullptr || release_ < failed_.at() + relief->back_off.count()) return nullptr;
  if (!empty(relief_, *relief)) return nullptr;
  relief->answer->fault = fault_;
  return relief;
}

MAUVE_RUNS_AT_A_SWAP bool Task::take(Published& next, Instant begin) {
  acknowledge();  // of a change that is overtaken at the same boundary
  tell_taken(next, begin);
  if (next.barrier != Published::Barrier::none) return wait_or_go_on(next), true;
  if (next.mode_only) keep_bundle(next);
  const bool waited = std::exchange(waiting_, false);
  running_ = running_ || waited;
  for (const auto& [port, before] : next.safe_writes) write_quietly(*port, *before, true);
  if (next.mode == Mode::park) write_safe_values();
  // Nothing is taken from a core that a lost thread may still be inside.
  const bool whole = current_->bundle->core.get() != lost_;
  if (whole && !take_state(next)) return false;
  const bool was_running = running_;
  take_rest(next);
  next.answer->pause = Duration{next.count_gap ? release_ - parked_at_ : state_time() - begin};
  if (waited) next.answer->pause = skip_gap(next.transaction->instant());
  if (was_running && running_ && !next.mode_only) {
    note(rt::EventKind::swapped, LogLevel::info, next.answer->pause.count(),
         static_cast<std::int64_t>(next.answer->bytes));
  }
  if (next.answer->failed) fail_in_hand_over(hand_over_fault_);
  return true;
}

/// A converter is code of the new core, so the guard looks at it as at a job. False: it did not
/// return, and this thread was given up in it.
MAUVE_RUNS_AT_A_SWAP bool Task::take_state(Published& next) {
  const bool converts = next.hand_over.convert != nullptr;
  Instant begun = state_time();
  if (converts) {
    taking_ = &next;
    watched_.busy_since.store(begun, std::memory_order_release);
  }
  const rt::Fault fault = next.hand_over.run(watched_);
  if (converts) {
    if (!watched_.busy_since.compare_exchange_strong(begun, 0)) return false;
    taking_ = nullptr;
  }
  next.answer->bytes = next.hand_over.bytes;
  next.answer->failed = fault.happened();
  hand_over_fault_ = fault;
  for (const auto& [into, from] : next.observables) into->continue_from(*from);
  return true;
}

/// Takes everything of the update but the state that the old core hands over. A start resumes a
/// component with a failed core as it resumes a stopped one.
MAUVE_RUNS_AT_A_SWAP void Task::take_rest(Published& next) {
  const bool was_running = running_ && !(failed_ && next.mode == Mode::run);
  next.bundle->shell->use(next.bundle->bindings.get());
  map_state(next);
  Published* const old = current_;
  put_in_place(next);
  rearm(next, was_running);
  unacknowledged_ = &next;
  pile_up(*old);
}

/// A task that does not run has nothing to wait with.
void Task::wait_or_go_on(Published& step) {
  if (step.barrier == Published::Barrier::wait) {
    waiting_ = std::exchange(running_, false);
  } else if (std::exchange(waiting_, false)) {
    running_ = true;
    step.answer->pause = skip_gap(step.transaction->instant());
  }
  // After a direct stop: what was written during a hand-over that came to nothing may be lost.
  if (!running_ && !waiting_ && halted()) write_safe_values();
  step.answer->progress.store(Published::Progress::done, std::memory_order_release);
  pile_up(step);  // last: from there it is freed
}

/// After a barrier: arms the first release at or after its end on the grid that it was on. The ones
/// before are lost. How much later the next job begins than it would have.
Duration Task::skip_gap(Instant until) {
  const Instant armed = release_;
  const Duration grid = current_->grid;
  if (!running_ || armed >= until || grid <= Duration{0}) return Duration{0};
  release_ = next_on_grid(armed, grid, until);
  miss(static_cast<std::uint64_t>((release_ - armed) / grid.count()), clock_.now(), true);
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  return Duration{release_ - armed};
}

/// It was made from what the model showed then; meanwhile the task may have gone back.
void Task::keep_bundle(Published& next) const {
  if (next.bundle == current_->bundle) return;
  next.bundle = current_->bundle;  // two counts each; the last one to go is never here
  next.nearby = current_->nearby;
  next.grid = current_->grid;
  next.shortest_wait = current_->shortest_wait;
  next.bound = current_->bound;
  next.has_safe_values = current_->has_safe_values;
}

/// What stood ready for the old bundle is of no use for another one.
MAUVE_RUNS_AT_A_SWAP void Task::put_in_place(Published& next) {
  const bool same_bundle = next.bundle == current_->bundle;
  if (!keeps_core(next, *current_)) failed_.forget();
  current_ = &next;
  bound_.store(next.bound.count(), std::memory_order_relaxed);
  has_safe_values_.store(next.has_safe_values, std::memory_order_relaxed);
  if (next.other_core) {
    counters_.execution_max.store(0, std::memory_order_relaxed);
    counters_.used_max.store(0, std::memory_order_relaxed);
  }
  if (same_bundle && next.back == nullptr && next.relief == nullptr) return;
  evidence_.begin_anew(back_.load(std::memory_order_relaxed) == nullptr);
  suspected_.store(false, std::memory_order_relaxed);
  if (next.back != nullptr || back_.load(std::memory_order_acquire) != nullptr) {
    Published* const before = back_.exchange(next.back.release(), std::memory_order_acq_rel);
    if (before != nullptr) pile_up(*before);
  }
  if (failed_ && next.mode_only) give_up_core();
  if (same_bundle && next.relief == nullptr) return;  // what stands by is of use still
  if (Published* relief = relief_.exchange(next.relief.release(), std::memory_order_acq_rel)) {
    relief->answer->progress.store(Published::Progress::given_back, std::memory_order_release);
    pile_up(*relief);
  }
}

MAUVE_RUNS_AT_A_SWAP void Task::map_state(const Published& next) {
  if (next.restart) {
    state_ = nullptr;
  } else if (state_ != nullptr && !next.state_map.empty()) {
    state_ = next.state_map[state_->index()];
  }
}

/// Stops, starts, or goes on at the release that was armed before.
MAUVE_RUNS_AT_A_SWAP void Task::rearm(const Published& next, bool was_running) {
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
    const auto passed = static_cast<std::uint64_t>((release_ - armed) / next.grid.count());
    miss(passed, clock_.now(), true);
  }
  wait_ = Duration{0};
  running_ = true;
  evidence_.forget_overruns();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  counters_.state.store(ComponentState::running, std::memory_order_release);
  tell(TraceKind::started, clock_.now(), release_ - t0_);
  note(rt::EventKind::started, LogLevel::info, release_ - t0_);
}

/// Another offset moves the grid: the armed release to the first instant of the new one after it.
/// A trace tells that as a start, since the wait had announced another instant.
MAUVE_RUNS_AT_A_SWAP void Task::keep_phase(const Published& next) {
  const Instant base = t0_ + next.bundle->task.offset.count();
  if (next.offset_changes) {
    release_ = next_on_grid(base, next.grid, release_);
    tell(TraceKind::started, clock_.now(), release_ - t0_);
  }
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

void Task::give_back(Published& next) {
  if (!claim(next)) return;
  tell(TraceKind::given_back, clock_.now(), 0, next.number);
  note(rt::EventKind::aborted, LogLevel::debug);
  next.answer->progress.store(Published::Progress::given_back, std::memory_order_release);
}

/// After the outputs of the first job with the new bundle, so that the answer costs them nothing.
MAUVE_RUNS_AT_A_SWAP void Task::acknowledge() {
  if (unacknowledged_ == nullptr) return;
  Published* const taken = std::exchange(unacknowledged_, nullptr);
  taken->answer->progress.store(Published::Progress::done, std::memory_order_release);
}

void Task::park(ComponentState state) {
  running_ = false;
  failed_.forget();
  parked_at_ = clock_.now();
  counters_.state.store(state, std::memory_order_release);
  if (state == ComponentState::stopped) {
    tell(TraceKind::stopped, parked_at_, parked_at_ - t0_);
    note(rt::EventKind::stopped, LogLevel::info, parked_at_ - t0_);
  }
}

void Task::note(rt::EventKind kind, LogLevel level, std::int64_t a, std::int64_t b) {
  events_.push({clock_.now(), kind, level, nullptr, LogArgument(a), LogArgument(b), {}});
}

}  // namespace mauve::exec
