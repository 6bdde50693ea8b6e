// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/lanes.h"

#include <algorithm>
#include <utility>

namespace mauve::ctl::mtrace {
namespace {

/// Goes through the records of one thread. A piece that began before the trace has no beginning and
/// is left out; one that did not end lasts until the end.
class Assembly {
 public:
  explicit Assembly(Lane& lane) : lane_(lane) {}

  void take(const Record& record) {
    switch (record.event) {
      case Event::release:
        return open_job(record);
      case Event::begin:
        return open_state(record);
      case Event::end:
        return close_state(record.time, record.a != 0);
      case Event::wait:
        return end_job(record);
      case Event::lock:
        if (record.a > 0) lane_.waits.push_back({record.time - record.a, record.time, record.name});
        held_.push_back({record.time, record.time, record.name});
        return;
      case Event::unlock:
        return close_hold(record);
      case Event::timeout:
        lane_.waits.push_back({record.time - record.a, record.time, record.name, true});
        return;
      case Event::lost:
        close_all(record.time);
        announced_ = false;
        break;
      case Event::fault:
        if (in_job_) lane_.jobs.back().failed = true;
        close_all(record.time);
        break;
      case Event::overrun:
        if (!lane_.jobs.empty()) lane_.jobs.back().late = record.a;
        break;
      case Event::missed:
        if (std::exchange(announced_, false)) lane_.jobs.back().missed = record.a;
        break;
      case Event::started:
        announced_ = false;  // the releases count from another one
        break;
      default:
        break;
    }
    lane_.marks.push_back(&record);
  }

  void close_all(std::int64_t time) {
    close_state(time, false);
    for (Span& hold : held_) {
      hold.to = time;
      lane_.holds.push_back(hold);
    }
    held_.clear();
    if (std::exchange(in_job_, false)) lane_.jobs.back().to = time;
  }

 private:
  void open_job(const Record& record) {
    close_all(record.time);
    lane_.jobs.push_back({});
    Job& job = lane_.jobs.back();
    job.release = record.a;
    job.from = job.to = record.time;
    job.change = record.b;
    in_job_ = true;
    announced_ = false;
  }
  void open_state(const Record& record) {
    close_state(record.time, false);
    lane_.states.push_back({record.time, record.time, record.name});
    in_state_ = true;
  }
  void close_state(std::int64_t time, bool preempted) {
    if (!std::exchange(in_state_, false)) return;
    lane_.states.back().to = time;
    lane_.states.back().flagged = preempted;
  }
  void end_job(const Record& record) {
    const bool in_job = in_job_;
    close_all(record.time);
    if (!in_job) return;
    Job& job = lane_.jobs.back();
    job.next = record.a;
    job.preempted = record.b != 0;
    job.whole = true;
    announced_ = true;
  }
  /// Locks may be left in another order than they were acquired.
  void close_hold(const Record& record) {
    const auto held = std::find_if(held_.rbegin(), held_.rend(),
                                   [&](const Span& one) { return one.name == record.name; });
    if (held == held_.rend()) return;
    held->to = record.time;
    lane_.holds.push_back(*held);
    held_.erase(std::next(held).base());
  }

  Lane& lane_;
  std::vector<Span> held_;
  bool in_job_ = false;
  bool announced_ = false;  // the last job named the next release, from which on some are missed
  bool in_state_ = false;
};

std::vector<Lane> empty_lanes(const Trace& trace) {
  std::vector<const Component*> order;
  for (const Component& one : trace.header.components) order.push_back(&one);
  // Ordinary threads run when no other does.
  const auto urgency = [](const Component& one) {
    return std::pair(one.realtime, one.realtime ? one.priority : 0);
  };
  std::stable_sort(order.begin(), order.end(), [&](const Component* x, const Component* y) {
    return urgency(*x) > urgency(*y);
  });
  std::vector<Lane> lanes;
  std::vector<bool> there(trace.words());
  const auto add = [&](Word thread, const Component* component) {
    if (there[thread]) return;
    there[thread] = true;
    lanes.push_back({});
    lanes.back().thread = thread;
    lanes.back().component = component;
  };
  for (const Component* one : order) {
    if (const auto thread = trace.find(one->name)) add(*thread, one);
  }
  for (const Record& record : trace.records) add(record.thread, nullptr);
  return lanes;
}

}  // namespace

std::vector<Lane> lanes_of(const Trace& trace) {
  std::vector<Lane> lanes = empty_lanes(trace);
  std::vector<Assembly*> by_thread(trace.words(), nullptr);
  std::vector<Assembly> assemblies;
  assemblies.reserve(lanes.size());
  for (Lane& lane : lanes) {
    assemblies.emplace_back(lane);
    by_thread[lane.thread] = &assemblies.back();
  }
  for (const Record& record : trace.records) by_thread[record.thread]->take(record);
  const std::int64_t end = trace.last_time();
  for (Assembly& one : assemblies) one.close_all(end);
  return lanes;
}

}  // namespace mauve::ctl::mtrace
