// SPDX-License-Identifier: LGPL-3.0-or-later
#include "mtrace/chrome.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "mtrace/lanes.h"
#include "protocol/framing.h"

namespace mauve::ctl::mtrace {
namespace {

using protocol::Json;

/// Microseconds with the nanoseconds behind the point: no rounding, however long it runs.
std::string microseconds(std::int64_t ns) {
  const auto size = ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%s%llu.%03llu", ns < 0 ? "-" : "",
                static_cast<unsigned long long>(size / 1000),
                static_cast<unsigned long long>(size % 1000));
  return text.data();
}

std::string in_json(std::string_view text) { return protocol::to_line(Json(text)); }

class Chrome {
 public:
  Chrome(const Trace& trace, std::ostream& out) : trace_(trace), out_(out) {}

  void write() {
    const Header& header = trace_.header;
    const Json other{{"architecture", header.architecture},
                     {"mauved", header.mauved},
                     {"why", header.why},
                     {"t", header.written},
                     {"t0_ns", header.t0},
                     {"lost", header.lost}};
    out_ << R"({"displayTimeUnit":"ns","otherData":)" << protocol::to_line(other)
         << ",\"traceEvents\":[\n";
    event("M", "process_name", 0, R"("args":{"name":"mauve"})");
    const auto lanes = lanes_of(trace_);
    for (const Lane& lane : lanes) keep_commits(lane);
    for (const Lane& lane : lanes) {
      ++thread_;
      name_thread(lane);
      slices(lane);
      for (const Record* mark : lane.marks) write(*mark);
    }
    out_ << "\n]}\n";
  }

 private:
  /// `rest`: further members, each after the first with a comma in front.
  void event(std::string_view phase, std::string_view name, std::int64_t time,
             const std::string& rest) {
    out_ << (first_ ? "" : ",\n") << R"({"ph":")" << phase << R"(","pid":1,"tid":)" << thread_
         << R"(,"ts":)" << microseconds(time) << R"(,"name":)" << in_json(name)
         << (rest.empty() ? "" : ",") << rest << "}";
    first_ = false;
  }
  void slice(std::string_view category, std::string_view name, std::int64_t from, std::int64_t to,
             const Json& args) {
    event("X", name, from,
          R"("cat":)" + in_json(category) + R"(,"dur":)" + microseconds(to - from) + R"(,"args":)" +
              protocol::to_line(args));
  }
  void name_thread(const Lane& lane) {
    event("M", "thread_name", 0, R"("args":{"name":)" + in_json(trace_.text(lane.thread)) + "}");
    event("M", "thread_sort_index", 0, R"("args":{"sort_index":)" + std::to_string(thread_) + "}");
  }
  void slices(const Lane& lane) {
    for (const Job& job : lane.jobs) {
      Json args{{"release_ns", job.release},
                {"start_late_ns", job.from - job.release},
                {"change", job.change}};
      if (job.whole) args["response_ns"] = job.to - job.release;
      if (job.whole) args["preempted"] = job.preempted;
      if (job.late > 0) args["late_ns"] = job.late;
      slice("job", job.failed ? "job that failed" : "job", job.from, job.to, args);
    }
    for (const Span& state : lane.states) {
      slice("state", trace_.text(state.name), state.from, state.to, {{"preempted", state.flagged}});
    }
    for (const Span& wait : lane.waits) {
      slice("lock", "wait for " + trace_.text(wait.name), wait.from, wait.to,
            {{"timed_out", wait.flagged}});
    }
    for (const Span& hold : lane.holds) {
      slice("lock", "hold " + trace_.text(hold.name), hold.from, hold.to, Json::object());
    }
  }

  void write(const Record& record) {
    switch (record.event) {
      case Event::user:
        return count(record);
      case Event::call:
        return slice("call", trace_.text(record.name), record.time - record.b, record.time,
                     {{"status", record.a}});
      case Event::disturbed:
        return slice("disturbance", "disturbed", record.time - record.a, record.time,
                     Json::object());
      case Event::commit:
        slice("change", title(record), record.time, record.time + 1000, args_of(record));
        return;
      case Event::applied:
        instant(record);
        return arrow(record);
      default:
        return instant(record);
    }
  }
  void instant(const Record& record) {
    event("i", title(record), record.time,
          R"("s":"t","cat":"event","args":)" + protocol::to_line(args_of(record)));
  }
  /// Counters belong to the process: the name contains the thread.
  void count(const Record& record) {
    if (!std::isfinite(record.value())) return;  // JSON has no word for it
    event("C", trace_.text(record.thread) + "." + trace_.text(record.name), record.time,
          R"("args":{"value":)" + protocol::to_line(Json(record.value())) + "}");
  }
  /// Each has a number of its own; it ends at the next slice, which is the first job with it.
  void arrow(const Record& applied) {
    const auto commit = commits_.find(applied.b);
    if (commit == commits_.end()) return;
    const std::string rest = R"("cat":"change","id":)" + std::to_string(++arrows_);
    const int thread = std::exchange(thread_, commit->second.thread);
    event("s", "change", commit->second.time, rest);
    thread_ = thread;
    event("f", "change", applied.time, rest);
  }

  [[nodiscard]] std::string title(const Record& record) const {
    std::string title(to_string(record.event));
    if (const std::string& name = trace_.text(record.name); !name.empty()) title += " " + name;
    return title;
  }
  [[nodiscard]] static Json args_of(const Record& record) {
    const EventWords& words = words_of(record.event);
    Json args = Json::object();
    if (!words.a.empty()) args[std::string(words.a)] = record.a;
    if (!words.b.empty()) args[std::string(words.b)] = record.b;
    return args;
  }
  void keep_commits(const Lane& lane) {
    const int thread = ++lane_number_;
    for (const Record* mark : lane.marks) {
      if (mark->event == Event::commit) commits_[mark->b] = {thread, mark->time};
    }
  }

  struct Commit {
    int thread = 0;
    std::int64_t time = 0;
  };

  const Trace& trace_;
  std::ostream& out_;
  std::map<std::int64_t, Commit> commits_;  // by number
  bool first_ = true;
  int thread_ = 0;
  int lane_number_ = 0;
  std::uint64_t arrows_ = 0;
};

}  // namespace

void write_chrome(const Trace& trace, std::ostream& out) { Chrome(trace, out).write(); }

}  // namespace mauve::ctl::mtrace
