// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rules that one thread obeys by itself.
#include <algorithm>
#include <utility>

#include "mtrace/findings.h"
#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

class ThreadCheck {
 public:
  ThreadCheck(Findings& findings, const Component* component,
              const std::set<std::int64_t>& at_barrier, std::uint64_t takes)
      : findings_(findings),
        trace_(findings.trace()),
        component_(component),
        at_barrier_(at_barrier),
        takes_left_(takes) {}

  void take(const Record& record) {
    switch (record.event) {
      case Event::release:
        return on_release(record);
      case Event::begin:
        return on_begin(record);
      case Event::end:
        return on_end(record);
      case Event::wait:
        return on_wait(record);
      case Event::lock:
        held_.push_back(record.name);
        return;
      case Event::unlock:
        return on_unlock(record);
      case Event::missed:
        return on_missed(record);
      case Event::applied:
        return on_applied(record);
      default:
        return on_rare(record);
    }
  }

  std::vector<SeenJob> jobs;

 private:
  void on_missed(const Record& record) {
    const std::int64_t count = std::clamp<std::int64_t>(record.a, 0, kMostMissed + 1);
    missed_ = std::min(missed_ + count, kMostMissed + 1);
    findings_.checked.missed += static_cast<std::uint64_t>(count);
  }

  void on_rare(const Record& record) {
    switch (record.event) {
      case Event::budget:
        ++findings_.checked.over_budget[trace_.text(record.thread)];
        if (!jobs.empty())
          jobs.back().disturbs = true;  // recorded at the end of the job, or behind it
        return;
      case Event::overrun:
        excuses_next_ = true;
        return;
      case Event::fault:
        if (in_job_) jobs.back().disturbs = true;
        if (in_job_) jobs.back().end = record.time;
        in_job_ = false;
        forget_job();
        excuses_next_ = failed_ = true;
        return;
      case Event::started:
        started_ = &record;
        started_before_take_ = false;
        stopped_ = nullptr;
        missed_ = 0;
        return;
      case Event::stopped:
        stopped_ = &record;
        started_ = nullptr;
        return;
      case Event::lost:
        findings_.left_out("records of " + name() + " were lost: checking began anew behind a gap");
        known_ = in_job_ = failed_ = false;
        forget_job();
        announced_ = last_ = stopped_ = started_ = nullptr;
        excuses_next_ = true;
        return;
      default:
        return;
    }
  }

  void on_release(const Record& record) {
    if (in_job_) {
      fail(record, "state",
           "was released again while its job of " + instant_in_words(jobs.back().instant()) +
               " had not ended",
           "a job ends with the record of its wait, or with a fault");
    }
    if (record.time < record.a) {
      fail(record, "release",
           "began " + length_in_words(record.a - record.time) + " before its release",
           "the clock of the machine went backwards, or the wait ended early");
    }
    check_instant(record);
    jobs.push_back({&record, record.time, false, std::exchange(excuses_next_, false)});
    if (jobs.size() > 1 && jobs[jobs.size() - 2].end > record.a) jobs.back().excused = true;
    forget_job();
    in_job_ = known_ = true;
    last_ = &record;
    announced_ = started_ = nullptr;
    barrier_ = failed_ = false;
    missed_ = 0;
    changed_since_release_ = false;
  }

  /// Whether the release is at the instant that the records before it announced.
  void check_instant(const Record& record) {
    if (stopped_ != nullptr) {
      fail(record, "release",
           "was released, and had stopped at " + instant_in_words(stopped_->time),
           "nothing says that it was started again");
      stopped_ = nullptr;
    }
    if (started_ != nullptr) {
      check_started(record);
    } else if (announced_ != nullptr && !failed_) {
      check_announced(record);
    }
    if (last_ != nullptr && record.a <= last_->a) {
      fail(record, "release",
           "was released for " + instant_in_words(record.a) + ", and before for " +
               instant_in_words(last_->a),
           "the logical clock only goes on");
    }
    // Another wait goes on from the release before it: on the grid is only where a start led.
    if (started_ != nullptr && !started_before_take_ && last_epoch() && component_ != nullptr &&
        component_->period > 0 && (record.a - component_->offset) % component_->period != 0) {
      fail(record, "release",
           "was released for " + instant_in_words(record.a) + ", which is not on its grid of " +
               length_in_words(component_->period) + " from " + length_in_words(component_->offset),
           "releases are at T0 + offset + a multiple of the grid");
    }
  }

  /// Behind a barrier, or when even the first release was missed, it is a later one of the grid.
  void check_started(const Record& record) {
    const std::int64_t grid = grid_now();
    if (missed_ == 0) return compare(record, started_->a, "its start announced");
    if (grid <= 0) return findings_.left_out("releases missed behind a start, of an older core");
    const std::int64_t after = record.a - started_->a;
    const bool fits = after % grid == 0 && after / grid >= missed_;
    compare(record, fits ? record.a : started_->a + missed_ * grid, kMissedMeans);
  }

  void check_announced(const Record& record) {
    const std::int64_t wait = announced_->a - announced_release_;
    if (missed_ > kMostMissed || wait > kLongest) {
      return findings_.left_out("releases of " + name() + " were missed for years");
    }
    // The missed releases were of the period in between, which no record states.
    if (barrier_ && missed_ > 0 && changed_since_release_) {
      return findings_.left_out("a release of " + name() + " behind a barrier and another change");
    }
    const std::int64_t expected = announced_->a + missed_ * wait;
    const std::int64_t late = record.a - expected;
    // A task that waited at a barrier goes on at a later release of its grid.
    const std::int64_t grid = grid_now();
    const std::int64_t after = record.a - announced_->a;
    const bool after_barrier = barrier_ && after >= 0 && (grid == 0 || after % grid == 0);
    const std::int64_t step = grid > 0 ? grid : wait;
    if (late > 0 && step > 0 && late % step == 0 && !after_barrier) {
      ++findings_.checked.releases;
      return fail(record, "lost",
                  "lost a release: " + std::string(missed_ > 0 ? kMissedMeans : kAnnounced) + " " +
                      instant_in_words(expected) + ", and it was released for " +
                      instant_in_words(record.a) + ", " + length_in_words(late) + " later",
                  "nothing says missed in between");
    }
    if (after_barrier) {
      ++findings_.checked.releases;
    } else {
      compare(record, expected, missed_ > 0 ? kMissedMeans : kAnnounced);
    }
  }

  void compare(const Record& record, std::int64_t expected, std::string_view why) {
    ++findings_.checked.releases;
    if (record.a == expected) return;
    fail(record, "release",
         "was released for " + instant_in_words(record.a) + ", and " + std::string(why) + " " +
             instant_in_words(expected),
         "the next release is the last one and the wait, never counted from now");
  }

  void on_begin(const Record& record) {
    if (!known_) return;
    ++findings_.checked.states;
    const std::string state = trace_.text(record.name);
    if (!in_job_) fail(record, "state", "began " + state + " outside of a job", kMachine);
    if (state_ != nullptr) {
      fail(record, "state", "began " + state + " within " + trace_.text(state_->name), kMachine);
    }
    check_kind(record, false);
    state_ = &record;
  }

  void on_end(const Record& record) {
    if (!known_) return;
    if (state_ == nullptr || state_->name != record.name) {
      fail(record, "state",
           "ended " + trace_.text(record.name) + ", which " +
               (state_ == nullptr ? "had not begun"
                                  : "is not what had begun, " + trace_.text(state_->name)),
           kMachine);
    }
    state_ = nullptr;
  }

  void on_wait(const Record& record) {
    if (!known_) return;
    const std::string state = trace_.text(record.name);
    if (!in_job_) {
      if (announced_ != nullptr) fail(record, "state", "waits in " + state + " twice", kMachine);
      return;
    }
    if (state_ != nullptr) {
      fail(record, "state",
           "waits in " + state + ", and " + trace_.text(state_->name) + " has not ended", kMachine);
    }
    if (!held_.empty()) {
      fail(record, "lock", "ended its job and still holds " + trace_.text(held_.back()),
           "a service leaves its resource before it returns");
    }
    check_kind(record, true);
    check_wait(record);
    jobs.back().end = record.time;
    jobs.back().whole = true;
    announced_ = &record;
    announced_release_ = jobs.back().instant();
    in_job_ = false;
    forget_job();
  }

  /// Is the state one of the machine, and of that kind? Before the last change it had another one.
  void check_kind(const Record& record, bool waits) {
    if (!last_epoch() || component_ == nullptr || component_->states.empty()) return;
    const std::string& called = trace_.text(record.name);
    const State* state = component_->state(called);
    if (state == nullptr) {
      fail(record, "state", "is in " + called + ", a state that its machine does not have",
           kMachine);
    } else if (state->waits != waits) {
      fail(record, "state",
           waits ? "waits in " + called + ", an execution state"
                 : "executes " + called + ", a synchronization state",
           kMachine);
    }
  }

  /// Whether a wait lasts as the machine requires; before the last change, as long as each time
  /// since the one before.
  void check_wait(const Record& record) {
    const std::int64_t length = record.a - jobs.back().instant();
    const State* state = last_epoch() && component_ != nullptr
                             ? component_->state(trace_.text(record.name))
                             : nullptr;
    const auto [known, fresh] = waits_.try_emplace(record.name, length);
    const std::int64_t expected = state != nullptr ? state->wait : known->second;
    if (state == nullptr && fresh) return;
    ++findings_.checked.waits;
    if (length == expected) return;
    fail(record, "wait",
         "waits in " + trace_.text(record.name) + " for " + length_in_words(length) +
             ", and that state" + (state != nullptr ? " says " : " took before ") +
             length_in_words(expected),
         "the next release is counted from this one's instant, not from now");
  }

  void on_unlock(const Record& record) {
    const auto held = std::find(held_.rbegin(), held_.rend(), record.name);
    if (held != held_.rend()) {
      held_.erase(std::next(held).base());
    } else if (in_job_) {
      fail(record, "lock", "left " + trace_.text(record.name) + ", which it did not hold",
           "a resource is left by who took it");
    }
  }

  void on_applied(const Record& record) {
    barrier_ = barrier_ || at_barrier_.contains(record.b);
    waits_.clear();
    started_before_take_ = started_ != nullptr;
    changed_since_release_ = changed_since_release_ || !at_barrier_.contains(record.b);
    if (takes_left_ > 0) --takes_left_;
  }

  void forget_job() {
    state_ = nullptr;
    held_.clear();
  }
  /// The header describes the components as they run since the last change of the trace.
  [[nodiscard]] bool last_epoch() const { return takes_left_ == 0; }
  /// Zero: not known, the header states that of a later core.
  [[nodiscard]] std::int64_t grid_now() const {
    return last_epoch() && component_ != nullptr ? component_->period : 0;
  }
  [[nodiscard]] std::string name() const {
    return component_ != nullptr ? component_->name : "a component";
  }
  void fail(const Record& record, std::string_view rule, const std::string& message,
            std::string_view hint) {
    findings_.violation(record, rule, trace_.text(record.thread) + " " + message,
                        std::string(hint));
  }

  static constexpr std::string_view kAnnounced = "its wait announced";
  static constexpr std::string_view kMissedMeans = "its wait and what it missed mean";
  static constexpr std::string_view kMachine =
      "a job is execution states, one after the other, and one synchronization state";
  static constexpr std::int64_t kMostMissed = 1'000'000;
  static constexpr std::int64_t kLongest = 1'000'000'000'000;

  Findings& findings_;
  const Trace& trace_;
  const Component* component_;
  const std::set<std::int64_t>& at_barrier_;
  std::uint64_t takes_left_;
  bool changed_since_release_ = false;  // by a change without a barrier
  std::map<Word, std::int64_t> waits_;  // how long, since the last change
  const Record* announced_ = nullptr;   // the wait that ended the last job
  std::int64_t announced_release_ = 0;
  const Record* last_ = nullptr;  // release
  const Record* started_ = nullptr;
  bool started_before_take_ = false;  // another change came before that release
  const Record* stopped_ = nullptr;
  const Record* state_ = nullptr;  // that has begun
  std::vector<Word> held_;
  std::int64_t missed_ = 0;
  bool known_ = false;  // a release was seen
  bool in_job_ = false;
  bool barrier_ = false;
  bool failed_ = false;
  bool excuses_next_ = false;
};

}  // namespace

SeenThread check_thread(Findings& findings, const Component* component,
                        const std::vector<const Record*>& records,
                        const std::set<std::int64_t>& at_barrier) {
  const auto takes = std::count_if(records.begin(), records.end(),
                                   [](const Record* one) { return one->event == Event::applied; });
  ThreadCheck thread(findings, component, at_barrier, static_cast<std::uint64_t>(takes));
  for (const Record* record : records) thread.take(*record);
  const bool whole = !records.empty() && records.front()->event == Event::started;
  return {component, std::move(thread.jobs), whole};
}

}  // namespace mauve::ctl::mtrace
