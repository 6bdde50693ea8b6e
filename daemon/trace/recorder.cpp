// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/recorder.h"

#include <algorithm>
#include <functional>
#include <set>

#include "base/mutex.h"
#include "base/thread_role.h"
#include "rt/process/pulse.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kEvery{50};
constexpr milliseconds kEveryInDetail{20};  // there is more of it
/// A recording goes on for so long after its event.
constexpr milliseconds kAfterwards{200};
/// [control] describes the system; when that takes longer, its last description is good enough.
constexpr milliseconds kAboutMayTake{1'000};
/// Each may take some megabytes.
constexpr std::size_t kSnapshots = 2;

}  // namespace

void Recorder::start(Running& running) {
  const MutexLock lock(mutex_);
  running_ = &running;
  about_ = running.deployer.traced();
  if (flights_wanted_ && running.store != nullptr) {
    flights_ = std::make_unique<Flights>(running.store->directory(), running.log);
  }
  set_trace_mode(mode());
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::trace);
    run();
  });
}

void Recorder::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
    write_when_due(true);
  }
}

TraceMode Recorder::mode() const {
  if (on_ && detail_) {
    return TraceMode::detail;
  }
  return on_ || flights_wanted_ ? TraceMode::jobs : TraceMode::off;
}

void Recorder::run() {
  rt::Pulse pulse("trace");
  for (;;) {
    pulse.turn();
    {
      MutexLock lock(mutex_);
      const auto wanted = [this]() MAUVE_REQUIRES(mutex_) {
        return stopping_ || on_ || flights_wanted_;
      };
      if (!wake_.wait_for(lock, rt::Pulse::kTurn, wanted)) continue;
      wake_.wait_for(lock, detail_ ? kEveryInDetail : kEvery,
                     [this]() MAUVE_REQUIRES(mutex_) { return stopping_; });
    }
    collect();
    write_when_due(false);
    const MutexLock lock(mutex_);
    if (stopping_) {
      return;
    }
  }
}

void Recorder::collect() {
  const MutexLock lock(mutex_);
  if (mode() == TraceMode::off) {
    return;
  }
  running_->deployer.drain_trace([this](const TraceRecord& record) MAUVE_REQUIRES(mutex_) {
    memory_.add(record);
    look(record);
  });
  const std::function<void(const TraceRecord&)> add =
      [this](const TraceRecord& record) MAUVE_REQUIRES(mutex_) { memory_.add(record); };
  for (const auto& probe : probes_) probe->drain(about_.t0, add);
}

/// One on each CPU that a real-time component may use.
void Recorder::start_probes() {
  std::set<int> cpus;
  for (const auto& component : about_.components) {
    const auto its = component.cpus.empty() ? rt::usable_cpus() : component.cpus;
    if (component.realtime) {
      cpus.insert(its.begin(), its.end());
    }
  }
  probes_.clear();
  for (const int cpu : cpus) {
    auto probe = std::make_unique<Probe>(cpu);
    if (probe->start()) {
      probes_.push_back(std::move(probe));
    }
  }
  probed_ = !cpus.empty() && probes_.size() == cpus.size();
}

/// Is it a reason to write? The members of a rollback follow its record.
void Recorder::look(const TraceRecord& record) {
  if (record.kind == TraceKind::lost) {
    lost_ += record.a;
  }
  auto& rollback = failures_.pending;
  if (record.kind == TraceKind::member && rollback && rollback->word == "rollback" &&
      rollback->component.empty()) {
    rollback->component = trace_name(record.name);
  }
  // Releases that a change lets pass are named; no thread was late for them.
  const bool missed = record.kind == TraceKind::missed && record.name == 0;
  const bool failed = record.kind == TraceKind::fault || record.kind == TraceKind::rollback;
  if ((missed || failed) && flights_ != nullptr) {
    wait_for_rest(missed ? misses_ : failures_, record);
  }
}

/// A flight recording that is about to be written covers this reason too.
void Recorder::wait_for_rest(Reason& reason, const TraceRecord& record) {
  if (reason.pending) {
    return;
  }
  const auto now = steady_clock::now();
  const bool of_control = record.kind == TraceKind::rollback;
  Pending flight{std::string(to_string(record.kind)),
                 of_control ? std::string{} : std::string(trace_name(record.thread)),
                 now + kAfterwards, std::make_shared<std::optional<TracedSystem>>()};
  if (!reason.allowance.take(now)) {
    if (&reason == &failures_) {
      report_skipped(reason.allowance, flight);
    }
    return;
  }
  reason.pending = std::move(flight);
  ask_what_it_is_about(*reason.pending);
}

void Recorder::report_skipped(const FlightAllowance& allowance, const Pending& flight) {
  const auto about = flight.word + (flight.component.empty() ? "" : " of " + flight.component);
  running_->log.write(Event::flight_skipped,
                      {{"component", flight.component},
                       {"text", about + " comes after " + std::to_string(allowance.count()) +
                                    " recordings of faults and rollbacks within " +
                                    std::to_string(allowance.per().count()) + " s"}});
}

void Recorder::ask_what_it_is_about(const Pending& pending) {
  running_->control.read([this, answer = pending.about] {
    auto about = running_->deployer.traced();
    const MutexLock lock(mutex_);
    about_ = about;
    *answer = std::move(about);
  });
}

void Recorder::write_when_due(bool now) {
  const MutexLock lock(mutex_);
  write_when_due(misses_, now);
  write_when_due(failures_, now);
}

/// On [disk], which may take its time; meanwhile this thread goes on collecting.
void Recorder::write_when_due(Reason& reason, bool now) {
  auto& pending = reason.pending;
  if (!pending) {
    return;
  }
  const auto time = steady_clock::now();
  const bool known = pending->about->has_value() || time >= pending->due + kAboutMayTake;
  if (!now && (time < pending->due || !known)) {
    return;
  }
  const Pending flight = *std::exchange(pending, std::nullopt);
  auto recording = std::make_shared<Recording>(cut(0));
  recording->why = flight.word + (flight.component.empty() ? "" : " " + flight.component);
  running_->store->disk().post([this, recording, flight] {
    flights_->write(*recording, flight.word, flight.component, running_->boot);
  });
}

/// The last seconds, and not before `from`.
Recording Recorder::cut(Instant from) const {
  const Instant now = running_->deployer.clock().now() - about_.t0;
  const Instant kept = std::chrono::nanoseconds(kept_).count();
  Recording recording = memory_.since(std::max(from, now - kept));
  recording.about = about_;
  recording.probed = on_ && probed_ && recording.from >= since_;
  return recording;
}

Status Recorder::begin(bool detail, std::chrono::seconds kept) {
  MAUVE_ON_THREAD(control);
  if (kept < std::chrono::seconds(1) || kept > kMostKept) {
    return refuse({Errc::invalid_value, "value_out_of_range"}, "seconds",
                  "must be from 1 to " + std::to_string(kMostKept.count()));
  }
  auto about = running_->deployer.traced();
  {
    const MutexLock lock(mutex_);
    about_ = std::move(about);
    on_ = true;
    detail_ = detail;
    kept_ = kept;
    since_ = running_->deployer.clock().now() - about_.t0;
    last_.reset();
    start_probes();
    set_trace_mode(mode());
  }
  wake_.notify_all();
  return ok();
}

Status Recorder::end() {
  MAUVE_ON_THREAD(control);
  collect();
  auto about = running_->deployer.traced();
  const MutexLock lock(mutex_);
  if (!on_) {
    return refuse({Errc::wrong_state, "trace_is_off"}, "trace", "is not on",
                  "mauvectl trace start begins one");
  }
  about_ = std::move(about);
  last_ = std::make_shared<Recording>(cut(since_));
  on_ = false;
  detail_ = false;
  kept_ = kKept;
  probes_.clear();
  probed_ = false;
  set_trace_mode(mode());
  return ok();
}

Result<std::pair<std::string, RecordingPtr>> Recorder::snapshot(bool now) {
  MAUVE_ON_THREAD(control);
  auto about = running_->deployer.traced();
  collect();
  const MutexLock lock(mutex_);
  const bool ended = !on_ && !now && last_ != nullptr;
  if (!on_ && !ended && !flights_wanted_) {
    return refuse({Errc::wrong_state, "trace_is_off"}, "trace", "nothing is traced",
                  "mauvectl trace start");
  }
  about_ = std::move(about);
  auto recording = std::make_shared<Recording>(ended ? *last_ : cut(on_ ? since_ : 0));
  recording->why = "command";
  snapshots_.emplace_back("snapshot-" + std::to_string(++snapshots_made_), recording);
  if (snapshots_.size() > kSnapshots) {
    snapshots_.pop_front();
  }
  return snapshots_.back();
}

RecordingPtr Recorder::find_snapshot(const std::string& name) const {
  MAUVE_ON_THREAD(control);
  const MutexLock lock(mutex_);
  const auto found = std::find_if(snapshots_.begin(), snapshots_.end(),
                                  [&](const auto& one) { return one.first == name; });
  return found == snapshots_.end() ? nullptr : found->second;
}

Json Recorder::status() const {
  const MutexLock lock(mutex_);
  return {{"on", on_},
          {"detail", detail_},
          {"since", on_ ? Json(since_) : Json()},
          {"seconds", kept_.count()},
          {"records", memory_.size()},
          {"bytes", memory_.bytes()},
          {"lost", lost_},
          {"flight_recorder", flights_wanted_},
          {"recordings", flights_ == nullptr ? 0 : flights_->list().size()}};
}

}  // namespace mauve::daemon
