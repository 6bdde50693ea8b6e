// SPDX-License-Identifier: LGPL-3.0-or-later
/// TimingModel: components in the form that the analysis of response times needs.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analysis/task_set.h"

#include <mauve/host/component.h>
#include <mauve/host/resource.h>
#include <mauve/host/timing.h>

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

/// The lock budgets that a change brings.
using Holds = std::map<const ResourceBase*, Duration>;

class TimingModel {
 public:
  explicit TimingModel(const analysis::Overheads& overheads, Holds holds = {})
      : holds_(std::move(holds)) {
    set_.overheads = overheads;
  }

  /// A declared budget counts before a measured time; a measured time counts with a margin of a
  /// fifth.
  void add(const TimedComponent& component);

  [[nodiscard]] const analysis::TaskSet& set() const { return set_; }
  /// How long their resources are held: declared, or measured with that margin.
  [[nodiscard]] std::vector<LockTiming> locks() const;
  /// True when a time in the set is a measured one: a later job may take longer.
  [[nodiscard]] bool measures() const;
  /// The times that are not in the set, or were measured rather than declared.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// The resources that were held for longer than declared.
  [[nodiscard]] const std::vector<std::string>& contradictions() const { return contradictions_; }

 private:
  std::vector<analysis::Section> sections_of(const TimedComponent& component);

  const LockTiming& lock_of(const ResourceBase& resource);

  analysis::TaskSet set_;
  const Holds holds_;
  std::map<std::string, LockTiming> locks_;
  std::vector<std::string> notes_;
  std::vector<std::string> contradictions_;
};

/// Does the model know both alike, but for priority and CPUs? Measured times do not count.
[[nodiscard]] bool is_timed_alike(const Bundle& a, const Bundle& b);

}  // namespace mauve::exec
