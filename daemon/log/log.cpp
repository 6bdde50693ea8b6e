// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/log.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

#include "base/mutex.h"
#include "base/thread_role.h"
#include "rt/process/pulse.h"

namespace mauve::logging {

Log::Log(Level level, std::size_t history) : levels_(level), history_(history) {}

Log::~Log() { stop(); }

void Log::add_sink(std::unique_ptr<Sink> sink) { sinks_.push_back({std::move(sink), 0, {}}); }

void Log::start() {
  {
    const MutexLock lock(mutex_);
    started_ = true;
  }
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::log);
    run();
  });
}

void Log::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Log::set_source(Source source) {
  const MutexLock lock(source_mutex_);
  source_ = std::move(source);
}

void Log::write(Event event, Fields fields) { write(make_record(event, std::move(fields))); }

/// A change of the level is logged at any level.
bool Log::passes(const Record& record) const {
  return record.event == Event::log_level_set || record.event == Event::log_level_reverted ||
         record.level >= levels_.of(record.component);
}

void Log::write(Record record) {
  if (!passes(record)) {
    return;
  }
  const MutexLock lock(mutex_);
  if (queue_.size() >= kQueue) {
    ++lost_;
    return;
  }
  stamp(record);  // here and not before the lock: the queue is in the order of time
  queue_.push_back(std::move(record));
  wake_.notify_one();
}

void Log::flush() {
  MutexLock lock(mutex_);
  if (!started_ || stopping_) {
    return;
  }
  // The round in progress may have drained its batch already: the one after it holds everything.
  const auto wanted = rounds_ + 2;
  while (rounds_ < wanted && !stopping_) {
    hurry_ = true;
    wake_.notify_all();
    done_.wait(lock);
  }
}

void Log::run() {
  rt::Pulse pulse("log");
  std::vector<Record> batch;  // begins with the records that the round before has held back
  for (bool last = false; !last;) {
    pulse.turn();
    std::uint64_t lost = 0;
    auto cut = std::numeric_limits<std::int64_t>::max();
    {
      MutexLock lock(mutex_);
      wake_.wait_for(lock, kPeriod, [this]() MAUVE_REQUIRES(mutex_) {
        return stopping_ || hurry_ || !queue_.empty();
      });
      hurry_ = false;
      last = stopping_;
      if (!last) {
        cut = monotonic_now();
      }
      std::move(queue_.begin(), queue_.end(), std::back_inserter(batch));
      queue_.clear();
      lost = std::exchange(lost_, 0);
    }
    if (lost > 0) {
      batch.push_back(make_record(Event::events_lost, {{"count", static_cast<std::int64_t>(lost)},
                                                       {"source", std::string("the daemon")}}));
    }
    look_at_levels(batch);
    collect(batch);
    pulse.turn(rt::Pulse::kBoundedElsewhere);  // a reader of the log may be slow
    write_up_to(batch, cut);
    {
      const MutexLock lock(mutex_);
      ++rounds_;
    }
    done_.notify_all();
  }
}

void Log::look_at_levels(std::vector<Record>& batch) {
  for (const auto& now : levels_.expire(std::chrono::steady_clock::now())) {
    batch.push_back(
        make_record(Event::log_level_reverted,
                    {{"component", now.component}, {"level", std::string(to_string(now.level))}}));
  }
}

void Log::collect(std::vector<Record>& batch) {
  const MutexLock lock(source_mutex_);
  if (source_) {
    source_([&](Record record) { batch.push_back(std::move(record)); });
  }
}

/// Records after the cut wait for the next round: the rings are emptied after the queue, so a
/// record in the queue may be older than one from a ring.
void Log::write_up_to(std::vector<Record>& batch, std::int64_t cut) {
  std::stable_sort(batch.begin(), batch.end(), [](const Record& a, const Record& b) {
    return a.monotonic_ns < b.monotonic_ns;
  });
  const auto end = std::find_if(batch.begin(), batch.end(),
                                [&](const Record& record) { return record.monotonic_ns > cut; });
  std::for_each(batch.begin(), end, [&](Record& record) { deliver(std::move(record)); });
  batch.erase(batch.begin(), end);
}

void Log::deliver(Record record) {
  if (!passes(record)) {
    return;
  }
  record.seq = ++seq_;
  history_.add(record);
  write_to_sinks(record);
}

/// A sink that fails is reported once, and once when it takes records again: after the record,
/// which is older, and to the sinks that work.
void Log::write_to_sinks(const Record& record) {
  std::vector<Record> reports;
  for (auto& sink : sinks_) {
    const auto missing = sink.missing;
    const auto written = write_to(sink, record);
    if (!written && missing == 0) {
      sink.target = written.error().at;
      reports.push_back(make_record(Event::sink_failed,
                                    {{"target", sink.target}, {"text", written.error().message}}));
    } else if (written && missing > 0) {
      reports.push_back(
          make_record(Event::sink_recovered,
                      {{"target", sink.target}, {"count", static_cast<std::int64_t>(missing)}}));
    }
  }
  for (auto& report : reports) {
    report.seq = ++seq_;
    history_.add(report);
    for (auto& sink : sinks_) {
      if (sink.missing == 0) {
        static_cast<void>(write_to(sink, report));
      }
    }
  }
}

/// A record that the sink refuses is counted.
Status Log::write_to(Destination& sink, const Record& record) {
  auto written = sink.sink->write(record);
  if (written) {
    sink.missing = 0;
  } else {
    unwritten_.fetch_add(1);
    ++sink.missing;
  }
  return written;
}

}  // namespace mauve::logging
