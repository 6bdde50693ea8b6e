// SPDX-License-Identifier: LGPL-3.0-or-later
#include "scheduler.h"

#include <algorithm>

namespace simulated {
namespace {

using mauve::analysis::Overheads;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// Part of a job, with or without a resource.
struct Segment {
  Time left = 0;
  std::size_t resource = kNone;
};

/// Where a task is in its graphs, and its job.
struct Walker {
  explicit Walker(Task of) : task(std::move(of)) {}

  Task task;
  std::size_t version = 0;
  std::size_t vertex = kNone;  // of the last release
  // The next release.
  Time release = 0;
  Time ready = 0;
  bool first = false;
  std::size_t next = kNone;  // vertex
  // The job that is not finished.
  bool busy = false;
  std::size_t job = kNone;  // its vertex
  std::vector<Segment> segments;
  std::size_t segment = 0;
  std::size_t holds = kNone;
  std::size_t awaits = kNone;
  std::uint64_t order = 0;
  Time released = 0;
  Time bound = 0;

  [[nodiscard]] const Version& now() const { return task.versions[version]; }
};

class Processor {
 public:
  Processor(std::vector<Task> tasks, const Overheads& overheads, Time grid, Random& random)
      : overheads_(overheads), grid_(grid), random_(random) {
    for (Task& task : tasks) walkers_.emplace_back(std::move(task));
    for (Walker& walker : walkers_) begin(walker, walker.task.offset);
    next_tick_ =
        overheads.tick.count() > 0 ? random.between(0, overheads.tick_period.count()) : kNever;
  }

  Result run(std::uint64_t jobs) {
    while (result_.jobs < jobs && result_.violation.empty()) {
      const Time event = next_event();
      if (event == kNever) break;
      execute_until(event);
      time_ = event;
      if (time_ == next_tick_) {
        kernel_ += overheads_.tick.count();
        next_tick_ += overheads_.tick_period.count();
      }
      expire();
      arrive();
    }
    return result_;
  }

 private:
  /// Plans the first job of a version, or of the first later one that has jobs, at `at` or later.
  void begin(Walker& walker, Time at) {
    walker.release = kNever;
    walker.ready = kNever;
    while (walker.now().graph.vertices.empty()) {
      if (walker.version + 1 == walker.task.versions.size()) return;
      ++walker.version;
      at = std::max(at, walker.task.starts[walker.version]);
    }
    plan(walker, at, starting(walker.now(), ""), false);
  }

  [[nodiscard]] static std::vector<std::size_t> starting(const Version& version,
                                                         const std::string& state) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < version.graph.vertices.size(); ++i) {
      if (version.graph.vertices[i].from == state) found.push_back(i);
    }
    return found;
  }

  void plan(Walker& walker, Time at, const std::vector<std::size_t>& choice, bool first) {
    walker.release = at;
    walker.ready = at + random_.between(0, walker.task.jitter);
    walker.next = choice[random_.below(choice.size())];
    walker.first = first;
  }

  /// After the release of `vertex`: what follows, perhaps in another version.
  void follow(Walker& walker) {
    const Version& version = walker.now();
    std::vector<std::size_t> choice;
    Time wait = 0;
    for (const mauve::analysis::Edge& edge : version.graph.edges) {
      if (edge.from != walker.vertex) continue;
      choice.push_back(edge.to);
      wait = edge.separation.count();
    }
    Time at = walker.release + wait;
    if (random_.chance(10)) at += grid_ * random_.between(1, 5);
    const bool change = walker.version + 1 < walker.task.versions.size() &&
                        walker.task.starts[walker.version + 1] <= at;
    if (!change) return plan(walker, at, choice, false);
    ++walker.version;
    if (walker.now().graph.vertices.empty()) return begin(walker, at);
    const std::string& state = version.graph.vertices[walker.vertex].to;
    choice = starting(walker.now(), state);
    if (choice.empty()) choice = starting(walker.now(), "");
    plan(walker, at, choice, true);
  }

  /// kNever when no task has anything left to do.
  [[nodiscard]] Time next_event() const {
    Time event = next_tick_;
    bool over = true;
    for (const Walker& walker : walkers_) {
      over = over && !walker.busy && walker.release == kNever;
      event = std::min(event, walker.release > time_ ? walker.release : walker.ready);
    }
    return over ? kNever : event;
  }

  /// One interrupt for all timers at this instant.
  void expire() {
    const bool any = std::any_of(walkers_.begin(), walkers_.end(),
                                 [this](const Walker& w) { return w.release == time_; });
    if (!any) return;
    if (idle() && overheads_.wake.count() > 0)
      kernel_ += random_.between(0, overheads_.wake.count());
    kernel_ += overheads_.interrupt.count();
  }
  [[nodiscard]] bool idle() const {
    return kernel_ == 0 && std::none_of(walkers_.begin(), walkers_.end(),
                                        [](const Walker& walker) { return walker.busy; });
  }

  void arrive() {
    for (Walker& walker : walkers_) {
      if (walker.ready > time_ || walker.ready == kNever) continue;
      if (walker.busy) {
        violate(walker, "was released before its last job ended");
        return;
      }
      make_job(walker);
      walker.vertex = walker.next;
      follow(walker);
    }
  }

  void make_job(Walker& walker) {
    const Version& version = walker.now();
    Time work = version.graph.vertices[walker.next].execution.count();
    if (walker.first) work += overheads_.change.count();
    if (random_.chance(30)) work = random_.between(0, work);
    walker.busy = true;
    walker.job = walker.next;
    walker.order = ++arrivals_;
    walker.released = walker.release;
    walker.bound = (walker.first ? version.first_bound : version.bound)[walker.next];
    walker.segment = 0;
    walker.segments.assign(1, {overheads_.activation.count(), kNone});
    for (const Section& section : walker.task.sections) {
      if (section.length > work || random_.chance(25)) continue;
      work -= section.length;
      const Time before = random_.chance(50) ? 0 : random_.between(0, work);
      work -= before;
      walker.segments.push_back({before, kNone});
      walker.segments.push_back({section.length, section.resource});
    }
    walker.segments.push_back({work, kNone});
  }

  void execute_until(Time end) {
    for (;;) {
      Walker* walker = choose();
      if (walker != nullptr && finish_empty(*walker)) continue;
      if (time_ >= end || !result_.violation.empty()) return;
      if (kernel_ > 0) {
        const Time spent = std::min(kernel_, end - time_);
        kernel_ -= spent;
        time_ += spent;
      } else if (walker == nullptr) {
        time_ = end;
      } else {
        Segment& segment = walker->segments[walker->segment];
        const Time spent = std::min(segment.left, end - time_);
        segment.left -= spent;
        time_ += spent;
      }
    }
  }

  /// Goes on to the next segment, or ends the job; false when there is work left.
  bool finish_empty(Walker& walker) {
    if (kernel_ > 0) return false;
    if (walker.segments[walker.segment].left > 0) return false;
    if (walker.holds != kNone) unlock(walker);
    if (++walker.segment < walker.segments.size()) return true;
    walker.busy = false;
    ++result_.jobs;
    const Time response = time_ - walker.released;
    if (response > walker.bound) violate(walker, "took longer than its bound");
    if (walker.bound > 0) {
      result_.tightest = std::max(
          result_.tightest, static_cast<double>(response) / static_cast<double>(walker.bound));
    }
    return true;
  }

  /// Whom the scheduler runs: locks are asked for as soon as a section is reached.
  Walker* choose() {
    for (;;) {
      Walker* best = nullptr;
      int best_priority = 0;
      for (Walker& walker : walkers_) {
        if (!walker.busy || walker.awaits != kNone) continue;
        const int priority = inherited(walker);
        const bool better = best == nullptr || priority > best_priority ||
                            (priority == best_priority && walker.order < best->order);
        if (!better) continue;
        best = &walker;
        best_priority = priority;
      }
      if (best == nullptr) return nullptr;
      const std::size_t resource = best->segments[best->segment].resource;
      if (resource == kNone || best->holds == resource) return best;
      if (kernel_ > 0) return best;
      (holder(resource) == nullptr ? best->holds : best->awaits) = resource;
    }
  }
  [[nodiscard]] int inherited(const Walker& walker) const {
    int priority = walker.task.priority;
    if (walker.holds == kNone) return priority;
    for (const Walker& other : walkers_) {
      if (other.awaits == walker.holds) priority = std::max(priority, other.task.priority);
    }
    return priority;
  }
  [[nodiscard]] const Walker* holder(std::size_t resource) const {
    for (const Walker& walker : walkers_) {
      if (walker.holds == resource) return &walker;
    }
    return nullptr;
  }
  void unlock(Walker& walker) {
    Walker* heir = nullptr;
    for (Walker& other : walkers_) {
      if (other.awaits != walker.holds) continue;
      if (heir == nullptr || other.task.priority > heir->task.priority) heir = &other;
    }
    if (heir != nullptr) std::swap(heir->holds, heir->awaits);
    walker.holds = kNone;
  }

  void violate(const Walker& walker, const char* what) {
    if (!result_.violation.empty()) return;
    result_.violation =
        walker.task.name + " " + what + ": released " + std::to_string(walker.released) + ", now " +
        std::to_string(time_) + ", bound " + std::to_string(walker.bound) + ", job " +
        std::to_string(walker.job) + " of version " + std::to_string(walker.version);
  }

  const Overheads overheads_;
  const Time grid_;
  Random& random_;
  std::vector<Walker> walkers_;
  Time time_ = -1;
  Time kernel_ = 0;  // work of the kernel that is not done yet
  Time next_tick_ = kNever;
  std::uint64_t arrivals_ = 0;
  Result result_;
};

}  // namespace

Result run(std::vector<Task> tasks, const Overheads& overheads, Time grid, std::uint64_t jobs,
           Random& random) {
  return Processor(std::move(tasks), overheads, grid, random).run(jobs);
}

}  // namespace simulated
