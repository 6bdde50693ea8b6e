// SPDX-License-Identifier: LGPL-3.0-or-later
/// TimingModel: components as the analysis of response times wants them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "analysis/task_set.h"

#include <mauve/component.h>

namespace mauve::exec {

/// A component that releases jobs.
struct TimedComponent {
  std::string name;
  const Bundle* bundle = nullptr;
  const FsmBase* fsm = nullptr;  ///< configured: its transitions are known
  std::vector<int> cpus;
  Duration measured{0};       ///< longest job of this type of core; 0: none was measured
  std::uint64_t version = 0;  ///< another number: another core or state machine
};

class TimingModel {
 public:
  explicit TimingModel(const analysis::Overheads& overheads) { set_.overheads = overheads; }

  /// A declared budget counts before what was measured; that counts with a margin of a fifth.
  void add(const TimedComponent& component);

  [[nodiscard]] const analysis::TaskSet& set() const { return set_; }
  /// What is not in the set, or was measured rather than declared.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  std::vector<analysis::Section> sections_of(const TimedComponent& component);

  analysis::TaskSet set_;
  std::vector<std::string> notes_;
  std::set<std::string> whole_jobs_;  ///< resources that count as held for whole jobs
};

}  // namespace mauve::exec
