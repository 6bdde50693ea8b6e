// SPDX-License-Identifier: LGPL-3.0-or-later
/// The data that the parts of a check share: their findings, and the excuses.
#pragma once

#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mtrace/check.h"

namespace mauve::ctl::mtrace {

/// "1.5 ms", exact.
[[nodiscard]] std::string length_in_words(std::int64_t ns);

/// A job as far as it was seen.
struct SeenJob {
  const Record* release = nullptr;
  std::int64_t end = 0;
  bool whole = false;
  bool excused = false;   ///< after an overrun, a fault or a gap: its response counts for nothing
  bool disturbs = false;  ///< took more than its budget, or failed: excuses others

  [[nodiscard]] std::int64_t instant() const { return release->a; }
  [[nodiscard]] std::int64_t start() const { return release->time; }
};

/// The jobs of one thread, after its own rules were checked.
struct SeenThread {
  const Component* component = nullptr;
  std::vector<SeenJob> jobs;
  bool whole = false;  ///< from its start on
  /// From then on it has the priority and the CPU of the header.
  std::int64_t scheduled = std::numeric_limits<std::int64_t>::min();
  /// Up to then the bounds of all components may have been others than those of the header.
  std::int64_t bounded = std::numeric_limits<std::int64_t>::min();
};

class Findings {
 public:
  explicit Findings(const Trace& trace) : trace_(trace) {}

  [[nodiscard]] const Trace& trace() const { return trace_; }
  void violation(const Record& at, std::string_view rule, std::string message, std::string hint);
  /// Reported once, with its count.
  void left_out(const std::string& what) { ++left_out_[what]; }
  [[nodiscard]] Verdict take();

  Checked checked;

 private:
  const Trace& trace_;
  std::optional<Violation> first_;
  std::uint64_t found_ = 0;
  std::map<std::string, std::uint64_t> found_of_;
  std::map<std::string, std::uint64_t> left_out_;
};

/// Times that excuse late jobs.
class Windows {
 public:
  void add(std::int64_t from, std::int64_t to) { windows_.push_back({from, to}); }
  void sort();
  [[nodiscard]] bool empty() const { return windows_.empty(); }
  /// After sort().
  [[nodiscard]] bool touch(std::int64_t from, std::int64_t to) const;

 private:
  struct Window {
    std::int64_t from;
    std::int64_t to;
  };
  std::vector<Window> windows_;
  std::vector<std::int64_t> latest_;  // end of any up to here
};

/// One thread, record by record. `at_barrier`: changes for which components waited.
[[nodiscard]] SeenThread check_thread(Findings& findings, const Component* component,
                                      const std::vector<const Record*>& records,
                                      const std::set<std::int64_t>& at_barrier);
void check_changes(Findings& findings, const std::map<Word, std::vector<const Record*>>& threads);
void check_order(Findings& findings, const std::vector<SeenThread>& threads,
                 const Windows& disturbed);
void check_responses(Findings& findings, const std::vector<SeenThread>& threads,
                     const Windows& disturbed);

}  // namespace mauve::ctl::mtrace
