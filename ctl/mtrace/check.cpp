// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/check.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <set>
#include <utility>

#include "mtrace/findings.h"
#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

/// The time that the machine takes to wake a thread, and the time around a disturbance in which it
/// has an effect, in ns.
constexpr std::int64_t kWake = 200'000;
constexpr std::int64_t kAround = 1'000'000;
/// A probe looks each millisecond and does not notice a delay of 200 us: a shorter disturbance may
/// lie between two looks.
constexpr std::int64_t kUnseen = 1'200'000;
/// The kernel may run the timer of a thread on another processor, and then wakes a more urgent
/// thread some us late. That is no violation when it happens once, or once in so many pairs of
/// jobs.
constexpr std::uint64_t kPairsPerLateTimer = 20;

std::map<Word, std::vector<const Record*>> by_thread(const Trace& trace) {
  std::map<Word, std::vector<const Record*>> threads;
  for (const Record& record : trace.records) threads[record.thread].push_back(&record);
  return threads;
}

/// Changes at which components waited for others: they go on at a later release.
std::set<std::int64_t> barriers_of(const Trace& trace) {
  std::set<std::int64_t> numbers;
  for (const Record& record : trace.records) {
    if (record.event == Event::applied && trace.text(record.name) == "barrier") {
      numbers.insert(record.b);
    }
  }
  return numbers;
}

/// The record of the last change, or rollback, that the thread applied; null: there is none.
const Record* last_applied(const Trace& trace, const std::vector<const Record*>& records) {
  const auto last = std::find_if(records.rbegin(), records.rend(), [&](const Record* record) {
    const std::string& as = trace.text(record->name);
    return record->event == Event::applied && (as == "change" || as == "back");
  });
  return last == records.rend() ? nullptr : *last;
}

/// True when the header describes the bundle that the thread runs at the end of the trace. While
/// [control] has not looked at the last change of the thread, the header describes an older one.
bool header_is_of_the_end(const Record* last, const Component& component) {
  return last == nullptr || !component.change || last->b == *component.change;
}

Windows disturbed_windows(const Trace& trace) {
  Windows windows;
  for (const Record& record : trace.records) {
    if (record.event != Event::disturbed) continue;
    windows.add(record.time - std::max<std::int64_t>(0, record.a) - kAround, record.time + kAround);
  }
  windows.sort();
  return windows;
}

void report_reading(Findings& findings) {
  const Reading& reading = findings.trace().reading;
  if (!reading.complete) findings.left_out("the file was cut off: its last line is missing");
  if (reading.broken > 0) {
    findings.left_out(counted(reading.broken, "line") + " that cannot be read, the first is line " +
                      std::to_string(reading.first_broken) + ": " + reading.first_reason);
  }
  if (reading.unknown > 0) {
    findings.left_out(counted(reading.unknown, "record") + " of events that are not known");
  }
  const std::uint64_t lost = findings.trace().header.lost;
  if (lost > 0)
    findings.left_out(counted(lost, "record") + " that mauved could not collect in time");
}

/// Of components that share one processor, the most urgent first.
std::map<std::int64_t, std::vector<const SeenThread*>> by_processor(
    const std::vector<SeenThread>& threads) {
  std::map<std::int64_t, std::vector<const SeenThread*>> processors;
  for (const SeenThread& one : threads) {
    if (one.component == nullptr || !one.component->realtime) continue;
    if (const auto cpu = one.component->cpu()) processors[*cpu].push_back(&one);
  }
  for (auto& [cpu, all] : processors) {
    std::stable_sort(all.begin(), all.end(), [](const SeenThread* x, const SeenThread* y) {
      return x->component->priority > y->component->priority;
    });
  }
  return processors;
}

void report_unknown_order(Findings& findings, const SeenThread& thread) {
  if (thread.jobs.empty() || thread.jobs.front().instant() >= thread.scheduled) return;
  findings.left_out("the order of " + thread.component->name + "'s jobs before " +
                    instant_in_words(thread.scheduled) +
                    ": the trace has only its later priority and CPU");
}

/// Goes through the jobs of a less urgent thread: did one begin while the other one was ready?
class OrderCheck {
 public:
  OrderCheck(Findings& findings, const SeenThread& urgent, const Windows& disturbed)
      : findings_(findings), urgent_(urgent), disturbed_(disturbed) {}

  void look_at(const SeenThread& other) {
    since_ = std::max(urgent_.scheduled, other.scheduled);
    pairs_ = swapped_ = 0;
    std::size_t next = 0;  // the job of the urgent one that has not begun
    for (const SeenJob& job : other.jobs) {
      while (next < urgent_.jobs.size() && urgent_.jobs[next].start() <= job.start()) ++next;
      if (job.instant() < since_) continue;
      const bool in_order = next > 0 && urgent_.jobs[next - 1].instant() == job.instant();
      if (in_order) count_pair();
      if (next < urgent_.jobs.size()) compare(other, job, next);
    }
    if (swapped_ == 0) return;
    if (swapped_ > 1 && swapped_ * kPairsPerLateTimer > pairs_) {
      return report(other, *first_job_, *first_waiting_);
    }
    findings_.left_out(
        "the order of jobs released together, where the more urgent one began less than 0.2 ms "
        "later in one of 20 pairs or fewer: the timer of another processor may have woken it");
  }

 private:
  void count_pair() {
    ++findings_.checked.orders;
    ++pairs_;
  }

  void compare(const SeenThread& other, const SeenJob& job, std::size_t next) {
    const SeenJob& waiting = urgent_.jobs[next];
    const bool together = waiting.instant() == job.instant();
    if (together) count_pair();
    std::int64_t ready = waiting.instant();
    // The urgent job before this one may have ended late. So may a job before the trace, which is
    // not seen.
    if (next == 0 && !urgent_.whole) return;
    if (next > 0) ready = std::max(ready, urgent_.jobs[next - 1].end);
    if (ready < since_) return;
    if (waiting.excused || job.start() < ready + (together ? 0 : kWake)) return;
    if (disturbed_.touch(ready, waiting.start())) {
      return findings_.left_out("pairs of jobs in windows of disturbance, for their order");
    }
    if (!together || waiting.start() - job.start() >= kWake) return report(other, job, waiting);
    if (swapped_++ > 0) return;
    first_job_ = &job;
    first_waiting_ = &waiting;
  }

  void report(const SeenThread& other, const SeenJob& job, const SeenJob& waiting) {
    findings_.violation(
        *job.release, "order",
        other.component->name + " (priority " + std::to_string(other.component->priority) +
            ") began " + length_in_words(waiting.start() - job.start()) + " before " +
            urgent_.component->name + " (priority " + std::to_string(urgent_.component->priority) +
            "), which was released for " + instant_in_words(waiting.instant()) +
            " on the same processor",
        "of those that are ready the most urgent one begins");
  }

  Findings& findings_;
  const SeenThread& urgent_;
  const Windows& disturbed_;
  std::int64_t since_ = 0;     // the trace has the priorities and the CPU of both
  std::uint64_t pairs_ = 0;    // of jobs that were released together
  std::uint64_t swapped_ = 0;  // of these began in the wrong order, one soon after the other
  const SeenJob* first_job_ = nullptr;
  const SeenJob* first_waiting_ = nullptr;
};

/// Jobs that took more than they may, or failed: the bounds of others do not count on them.
Windows windows_of_others(const std::vector<SeenThread>& threads) {
  Windows windows;
  for (const SeenThread& thread : threads) {
    for (const SeenJob& job : thread.jobs) {
      if (job.disturbs) windows.add(job.start(), job.end + kAround);
    }
  }
  windows.sort();
  return windows;
}

class ResponseCheck {
 public:
  /// `since`: from then on the bounds are those of the header.
  ResponseCheck(Findings& findings, const Windows& disturbed, Windows others, std::int64_t since)
      : findings_(findings), disturbed_(disturbed), others_(std::move(others)), since_(since) {}

  void judge(const Component& component, const SeenJob& job) const {
    const std::int64_t response = job.end - job.instant();
    const std::int64_t beyond = response - *component.bound;
    if (disturbed_.touch(job.instant(), job.end)) {
      return findings_.left_out("responses in windows of disturbance");
    }
    if (job.excused || others_.touch(job.instant(), job.end)) {
      return findings_.left_out(
          "responses after an overrun, a fault, a gap or a job over its budget");
    }
    if (beyond > 0 && component.measured) {
      return findings_.left_out(
          "responses beyond a bound that rests on measured times: a job may take longer than was "
          "measured, so declare budgets");
    }
    if (beyond > 0 && beyond < (disturbed_.empty() ? kWake : kUnseen)) {
      return findings_.left_out(
          disturbed_.empty()
              ? "responses beyond the bound by less than 0.2 ms: no trace has so short a "
                "disturbance"
              : "responses beyond the bound by less than 1.2 ms, on a machine that was disturbed: "
                "the trace may lack such a short disturbance");
    }
    if (beyond > 0 && job.instant() < since_) {
      return findings_.left_out("responses beyond the bound before " + instant_in_words(since_) +
                                ": the trace has only the later bound");
    }
    if (beyond > 0 && !findings_.trace().header.probed) {
      return findings_.left_out(
          "responses beyond the bound: only after `trace start` does a trace record when the host "
          "held a CPU up");
    }
    ++findings_.checked.responses;
    ++findings_.checked.responses_of[component.name];
    if (beyond <= 0) return;
    findings_.violation(
        *job.release, "response",
        component.name + " responded in " + length_in_words(response) + " to its release for " +
            instant_in_words(job.instant()) + ", and " + length_in_words(*component.bound) +
            " were admitted",
        "mauvectl analyze shows what the bound is made of; mauvectl timeline shows what ran");
  }

 private:
  Findings& findings_;
  const Windows& disturbed_;
  Windows others_;
  std::int64_t since_;
};

/// Each bound depends on the attributes of all components.
std::int64_t last_bounded(const std::vector<SeenThread>& threads) {
  std::int64_t last = std::numeric_limits<std::int64_t>::min();
  for (const SeenThread& thread : threads) last = std::max(last, thread.bounded);
  return last;
}

/// Since when the thread has the attributes of the header. `last`: its last change.
void date(SeenThread& seen, const Record* last, const std::vector<const Record*>& records) {
  const Component* const component = seen.component;
  // A header without the time is of an older mauved: any change may be that of the attributes.
  const auto change = last != nullptr ? std::optional(last->time) : std::nullopt;
  if (component == nullptr) {
    seen.bounded = records.back()->time;  // it left, or its change is not in the header yet
    return;
  }
  if (const auto at = component->scheduled ? component->scheduled : change) seen.scheduled = *at;
  if (const auto at = component->timed ? component->timed : change) seen.bounded = *at;
  seen.bounded = std::max(seen.bounded, seen.scheduled);
}

}  // namespace

std::string length_in_words(std::int64_t ns) {
  struct Unit {
    std::int64_t ns;
    const char* name;
  };
  constexpr std::array<Unit, 3> kUnits{{{1'000'000'000, "s"}, {1'000'000, "ms"}, {1'000, "us"}}};
  for (const Unit& unit : kUnits) {
    if (std::abs(ns) < unit.ns) continue;
    std::string text = std::to_string(std::abs(ns) % unit.ns + unit.ns);
    text.front() = '.';  // in place of a one that keeps the zeros
    text.erase(text.find_last_not_of('0') + 1);
    if (text == ".") text.clear();
    return std::to_string(ns / unit.ns) + text + " " + unit.name;
  }
  return std::to_string(ns) + " ns";
}

void Findings::violation(const Record& at, std::string_view rule, std::string message,
                         std::string hint) {
  ++found_;
  ++found_of_[std::string(rule)];
  if (first_ && first_->time <= at.time) return;
  first_ = {std::string(rule), trace_.text(at.thread), at.time,
            at.line,           std::move(message),     std::move(hint)};
}

Verdict Findings::take() {
  Verdict verdict{std::move(first_), found_, std::move(found_of_), checked, {}};
  for (const auto& [what, times] : left_out_) {
    verdict.not_checked.push_back(times > 1 ? what + " (" + std::to_string(times) + " times)"
                                            : what);
  }
  return verdict;
}

void Windows::sort() {
  std::sort(windows_.begin(), windows_.end(),
            [](const Window& x, const Window& y) { return x.from < y.from; });
  latest_.clear();
  for (const Window& one : windows_) {
    latest_.push_back(latest_.empty() ? one.to : std::max(latest_.back(), one.to));
  }
}

bool Windows::touch(std::int64_t from, std::int64_t to) const {
  const auto behind =
      std::upper_bound(windows_.begin(), windows_.end(), to,
                       [](std::int64_t time, const Window& one) { return time < one.from; });
  if (behind == windows_.begin()) return false;
  return latest_[static_cast<std::size_t>(behind - windows_.begin()) - 1] >= from;
}

void check_order(Findings& findings, const std::vector<SeenThread>& threads,
                 const Windows& disturbed) {
  for (const auto& [cpu, all] : by_processor(threads)) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all.size() > 1) report_unknown_order(findings, *all[i]);
      for (std::size_t k = i + 1; k < all.size(); ++k) {
        if (all[i]->component->priority == all[k]->component->priority) continue;
        OrderCheck(findings, *all[i], disturbed).look_at(*all[k]);
      }
    }
  }
}

void check_responses(Findings& findings, const std::vector<SeenThread>& threads,
                     const Windows& disturbed) {
  const ResponseCheck check(findings, disturbed, windows_of_others(threads), last_bounded(threads));
  for (const SeenThread& thread : threads) {
    if (thread.component == nullptr) continue;
    if (!thread.component->bound) {
      findings.left_out("responses of components that have no admitted bound");
      continue;
    }
    for (const SeenJob& job : thread.jobs) {
      if (job.whole) check.judge(*thread.component, job);
    }
  }
}

Verdict check(const Trace& trace) {
  Findings findings(trace);
  report_reading(findings);
  const auto threads = by_thread(trace);
  const auto barriers = barriers_of(trace);
  std::vector<SeenThread> seen;
  for (const auto& [thread, records] : threads) {
    const Component* component = trace.component(thread);
    const std::string& name = trace.text(thread);
    if (name == kControl || name == kProbe) continue;
    const Record* last = last_applied(trace, records);
    if (component == nullptr) {
      findings.left_out("the grid, states and bound of " + name + ", which left before the end");
    } else if (!header_is_of_the_end(last, *component)) {
      findings.left_out("the grid, states and bound of " + name +
                        ", whose last change the header does not show yet");
      component = nullptr;
    }
    ++findings.checked.components;
    seen.push_back(check_thread(findings, component, records, barriers));
    date(seen.back(), last, records);
  }
  const Windows disturbed = disturbed_windows(trace);
  check_changes(findings, threads);
  check_order(findings, seen, disturbed);
  check_responses(findings, seen, disturbed);
  return findings.take();
}

}  // namespace mauve::ctl::mtrace
