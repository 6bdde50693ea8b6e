// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/scene.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "base/duration.h"
#include "render/words.h"

namespace mauve::ctl::mtrace {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kPeriods = 5;        // around the event that the trace was kept for
constexpr std::int64_t kReadableJobs = 50;  // of one component, where no window is asked for
constexpr std::int64_t kAir = 80;           // part of the window on both sides

struct Interval {
  std::int64_t from;
  std::int64_t to;
};
using Intervals = std::vector<Interval>;

template <typename T>
bool within(const T& span, const Scene& scene) {
  return span.to >= scene.from && span.from <= scene.to;
}

/// Sorted, without overlaps.
Intervals merged(Intervals all) {
  std::sort(all.begin(), all.end(),
            [](const Interval& x, const Interval& y) { return x.from < y.from; });
  Intervals result;
  for (const Interval& one : all) {
    if (!result.empty() && one.from <= result.back().to) {
      result.back().to = std::max(result.back().to, one.to);
    } else {
      result.push_back(one);
    }
  }
  return result;
}

/// When it had, or wanted, the processor: its jobs without the waits for locks.
Intervals demand_of(const Lane& lane, const Scene& scene) {
  Intervals waits;
  for (const Span& wait : lane.waits) {
    if (within(wait, scene)) waits.push_back({wait.from, wait.to});
  }
  waits = merged(std::move(waits));
  Intervals result;
  for (const Job& job : lane.jobs) {
    if (!within(job, scene)) continue;
    std::int64_t from = job.from;
    auto wait = std::lower_bound(waits.begin(), waits.end(), job.from,
                                 [](const Interval& x, std::int64_t time) { return x.to < time; });
    for (; wait != waits.end() && wait->from < job.to; ++wait) {
      if (wait->from > from) result.push_back({from, wait->from});
      from = std::max(from, wait->to);
    }
    if (from < job.to) result.push_back({from, job.to});
  }
  return result;
}

// --- the window ---------------------------------------------------------------------------------

/// The component of "missed control".
std::string whom(const std::string& why) {
  const auto space = why.find(' ');
  return space == std::string::npos ? std::string{} : why.substr(space + 1);
}

/// The last record of the event for which the trace was kept.
const Record* cause_of(const Trace& trace) {
  const std::string& why = trace.header.why;
  const auto space = why.find(' ');
  const auto event = event_named(why.substr(0, space));
  if (!event) return nullptr;
  const std::string who = whom(why);
  const auto is_it = [&](const Record& one) {
    return one.event == *event &&
           (who.empty() || trace.text(one.thread) == who || trace.text(one.name) == who);
  };
  const auto found = std::find_if(trace.records.rbegin(), trace.records.rend(), is_it);
  if (found != trace.records.rend()) return &*found;
  const auto any = std::find_if(trace.records.rbegin(), trace.records.rend(),
                                [&](const Record& one) { return one.event == *event; });
  return any == trace.records.rend() ? nullptr : &*any;
}

std::int64_t longest_wait(const Component& component) {
  std::int64_t longest = component.period;
  for (const State& state : component.states) longest = std::max(longest, state.wait);
  return longest;
}

/// Of the component that it is about, or the longest of all that are not rare.
std::int64_t period_around(const Trace& trace, const Record& cause) {
  const auto named = trace.find(whom(trace.header.why));
  const Component* component = trace.component(named.value_or(cause.thread));
  std::int64_t period = component != nullptr ? longest_wait(*component) : 0;
  if (period > 0) return period;
  for (const Component& one : trace.header.components) {
    period = std::max(period, std::min(longest_wait(one), kSecond / kPeriods));
  }
  return period > 0 ? period : kSecond / kPeriods;
}

std::int64_t most_jobs_of_one(const Scene& scene) {
  std::ptrdiff_t most = 0;
  for (const Lane& lane : scene.lanes) {
    most = std::max(most, std::count_if(lane.jobs.begin(), lane.jobs.end(),
                                        [&](const Job& job) { return within(job, scene); }));
  }
  return most;
}

/// The release of the last job of the lane that began before the time; the time if there is none.
std::int64_t release_before(const Lane& lane, std::int64_t time) {
  const auto behind =
      std::lower_bound(lane.jobs.begin(), lane.jobs.end(), time,
                       [](const Job& job, std::int64_t at) { return job.from < at; });
  return behind == lane.jobs.begin() ? time : std::prev(behind)->release;
}

/// Before the job that the cause is about, and before the jobs that ran on its processor meanwhile:
/// one of them is the culprit.
std::int64_t beginning_of(const Scene& scene, const Record& cause) {
  const auto its = std::find_if(scene.lanes.begin(), scene.lanes.end(),
                                [&](const Lane& lane) { return lane.thread == cause.thread; });
  if (its == scene.lanes.end() || its->component == nullptr) return cause.time;
  const std::int64_t since = release_before(*its, cause.time);
  const auto cpu = its->component->cpu();
  std::int64_t from = since;
  for (const Lane& lane : scene.lanes) {
    const bool beside = cpu && lane.component != nullptr && lane.component->realtime &&
                        lane.component->cpu() == cpu;
    if (!beside) continue;
    for (const Job& job : lane.jobs) {
      if (job.to > since && job.from < cause.time) from = std::min(from, job.release);
    }
  }
  return from;
}

void choose_window(Scene& scene, const Trace& trace, const View& view) {
  const std::int64_t first = trace.first_time();
  const std::int64_t last = std::max(trace.last_time(), first);
  scene.from = first;
  scene.to = last;
  const Record* cause = cause_of(trace);
  if (view.from || view.to) {
    scene.from = view.from.value_or(first);
    scene.to = view.to.value_or(last);
  } else if (cause != nullptr) {
    const std::int64_t period = period_around(trace, *cause);
    scene.from = std::max(first, cause->time - (kPeriods + 1) * period / 2);
    scene.to = std::min(last, scene.from + kPeriods * period);
    scene.from = std::max(first, std::min(scene.from, beginning_of(scene, *cause)));
  } else {
    scene.from = std::max(first, last - kSecond);
    // Jobs of the most frequent component must stay apart in the picture.
    const std::int64_t jobs = most_jobs_of_one(scene);
    if (jobs > kReadableJobs) scene.from = last - (last - scene.from) * kReadableJobs / jobs;
  }
  if (scene.to <= scene.from) scene.to = scene.from + 1;
  const bool whole = scene.from <= first && scene.to >= last;
  // A release lies before the job that it begins, and marks at the edge need room.
  const std::int64_t air = (scene.to - scene.from) / kAir + 1;
  if (!view.from) scene.from -= air;
  if (!view.to) scene.to += air;
  if (!whole) {
    scene.left_out.push_back(
        "the trace goes from " + instant_in_words(first) + " to " + instant_in_words(last) +
        (view.from || view.to ? "" : "; --from and --to choose another part of it"));
  }
}

// --- the rows -----------------------------------------------------------------------------------

std::int64_t busy_time(const Lane& lane, const Scene& scene) {
  std::int64_t sum = 0;
  for (const Job& job : lane.jobs) {
    if (!within(job, scene)) continue;
    sum += std::min(job.to, scene.to) - std::max(job.from, scene.from);
  }
  return sum;
}

/// Names the rows that are left out, so that a user finds them with --component.
void keep_the_busiest(std::vector<const Lane*>& all, Scene& scene) {
  if (all.size() <= kMostRows) return;
  std::vector<std::pair<std::int64_t, const Lane*>> order;
  for (const Lane* lane : all) order.emplace_back(-busy_time(*lane, scene), lane);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& x, const auto& y) { return x.first < y.first; });
  std::set<const Lane*> idle;
  std::string names;
  for (std::size_t i = kMostRows; i < order.size(); ++i) {
    idle.insert(order[i].second);
    if (i < kMostRows + 8) names += " " + order[i].second->component->name;
  }
  std::erase_if(all, [&](const Lane* lane) { return idle.contains(lane); });
  scene.left_out.push_back(counted(idle.size(), "component") + " that ran the least:" + names +
                           (idle.size() > 8 ? " ..." : "") + "; --component chooses");
}

std::vector<const Lane*> choose_rows(Scene& scene, const View& view) {
  std::vector<const Lane*> chosen;
  const auto& wanted = view.components;
  std::set<std::string> found;
  for (const Lane& lane : scene.lanes) {
    if (lane.component == nullptr) continue;
    const std::string& name = lane.component->name;
    const bool named = std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    if (wanted.empty() || named) chosen.push_back(&lane);
    if (named) found.insert(name);
  }
  for (const std::string& name : wanted) {
    if (!found.contains(name))
      scene.left_out.push_back("the component " + name + ", which has no records in it");
  }
  if (wanted.empty()) keep_the_busiest(chosen, scene);
  return chosen;
}

// --- the boxes ----------------------------------------------------------------------------------

/// A part of a job, cut where it waited for a lock or something more urgent had the processor.
class Cutter {
 public:
  Cutter(Row& row, const Intervals& urgent, const Scene& scene)
      : row_(row), urgent_(urgent), scene_(scene) {
    for (const Span& wait : row.lane->waits) {
      if (within(wait, scene)) waits_.push_back({wait.from, wait.to});
    }
    waits_ = merged(std::move(waits_));
  }

  void cut(const Box& whole) {
    std::int64_t at = whole.from;
    while (at < whole.to) {
      const Interval* wait = next(waits_, at);
      const Interval* urgent = next(urgent_, at);
      const bool waits = wait != nullptr && wait->from <= at;
      const bool preempted = !waits && urgent != nullptr && urgent->from <= at;
      std::int64_t to = whole.to;
      if (wait != nullptr) to = std::min(to, waits ? wait->to : wait->from);
      if (urgent != nullptr && !waits) to = std::min(to, preempted ? urgent->to : urgent->from);
      Box box = whole;
      box.from = at;
      box.to = to;
      if (waits) box.piece = Piece::blocked;
      if (preempted) box.piece = Piece::preempted;
      if (within(box, scene_)) row_.boxes.push_back(box);
      at = to;
    }
    if (whole.from == whole.to) row_.boxes.push_back(whole);
  }

 private:
  static const Interval* next(const Intervals& all, std::int64_t at) {
    const auto found =
        std::upper_bound(all.begin(), all.end(), at,
                         [](std::int64_t time, const Interval& one) { return time < one.to; });
    return found == all.end() ? nullptr : &*found;
  }

  Row& row_;
  const Intervals& urgent_;
  const Scene& scene_;
  Intervals waits_;
};

const Job* job_at(const Lane& lane, std::int64_t time) {
  const auto behind =
      std::upper_bound(lane.jobs.begin(), lane.jobs.end(), time,
                       [](std::int64_t at, const Job& job) { return at < job.from; });
  if (behind == lane.jobs.begin()) return nullptr;
  const Job& job = *std::prev(behind);
  return job.to >= time ? &job : nullptr;
}

void add_boxes(Row& row, const Intervals& urgent, const Scene& scene) {
  Cutter cutter(row, urgent, scene);
  std::set<const Job*> separate;
  for (const Span& state : row.lane->states) {
    if (!within(state, scene)) continue;
    const Job* job = job_at(*row.lane, state.from);
    separate.insert(job);
    cutter.cut({Piece::runs, state.from, state.to, state.name, job});
  }
  for (const Job& job : row.lane->jobs) {
    if (!within(job, scene) || separate.contains(&job)) continue;
    cutter.cut({Piece::job, job.from, job.to, 0, &job});
  }
}

/// Jobs nearer to each other than `nearest` become one box.
void add_dense(Row& row, std::int64_t nearest, const Scene& scene) {
  for (const Job& job : row.lane->jobs) {
    if (!within(job, scene)) continue;
    if (!row.boxes.empty() && job.from - row.boxes.back().to < nearest) {
      Box& box = row.boxes.back();
      box.piece = Piece::many;
      box.to = std::max(box.to, job.to);
      ++box.count;
    } else {
      row.boxes.push_back({Piece::job, job.from, job.to, 0, &job});
    }
  }
}

/// How many boxes all rows may have, and which of them have too many for boxes of their own.
class Budget {
 public:
  Budget(Scene& scene, double smallest) : scene_(scene), smallest_(smallest) {
    std::size_t all = 0;
    for (const Row& row : scene.rows) all += spans_of(row);
    if (all <= kMostBoxes) return;
    const std::size_t share = kMostBoxes / scene.rows.size();
    std::size_t left = kMostBoxes;
    for (Row& row : scene.rows) {
      row.dense = spans_of(row) > share;
      if (!row.dense) left -= spans_of(row);
      dense_ += row.dense ? 1 : 0;
    }
    nearest_ = static_cast<double>(dense_) / static_cast<double>(std::max<std::size_t>(1, left));
    scene.left_out.push_back("the states of " + counted(dense_, "component") +
                             ", which are too many; --from and --to choose a shorter part");
  }

  void fill(Row& row, const Intervals& urgent) const {
    if (!row.dense) return add_boxes(row, urgent, scene_);
    const double length = static_cast<double>(scene_.to - scene_.from);
    add_dense(row, static_cast<std::int64_t>(std::max(smallest_, nearest_) * length), scene_);
  }

 private:
  [[nodiscard]] std::size_t spans_of(const Row& row) const {
    const auto in_window = [&](const auto& span) { return within(span, scene_); };
    const auto& states = row.lane->states;
    const auto& jobs = row.lane->jobs;
    return static_cast<std::size_t>(std::max(std::count_if(states.begin(), states.end(), in_window),
                                             std::count_if(jobs.begin(), jobs.end(), in_window)));
  }

  Scene& scene_;
  double smallest_;
  double nearest_ = 0.0;
  std::size_t dense_ = 0;
};

}  // namespace

Scene scene_of(const Trace& trace, const View& view, double smallest) {
  Scene scene;
  scene.lanes = lanes_of(trace);
  choose_window(scene, trace, view);
  for (const Lane* lane : choose_rows(scene, view)) scene.rows.push_back({lane, {}, false});
  // Lanes stand in the order of urgency: a task above has the processor before those below.
  const Budget budget(scene, smallest);
  std::map<std::int64_t, Intervals> urgent;
  for (const Lane& lane : scene.lanes) {
    const auto cpu = lane.component != nullptr ? lane.component->cpu() : std::nullopt;
    static const Intervals kNothing;
    const Intervals& above = cpu ? urgent[*cpu] : kNothing;
    const auto row = std::find_if(scene.rows.begin(), scene.rows.end(),
                                  [&](const Row& one) { return one.lane == &lane; });
    if (row != scene.rows.end()) budget.fill(*row, above);
    if (!cpu || !lane.component->realtime) continue;
    Intervals all = demand_of(lane, scene);
    all.insert(all.end(), above.begin(), above.end());
    urgent[*cpu] = merged(std::move(all));
  }
  return scene;
}

}  // namespace mauve::ctl::mtrace
