// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/rbf.h"

#include <algorithm>
#include <limits>

namespace mauve::analysis {
namespace {

/// A path that ends in `vertex`, released at `at`, with all its work.
struct Path {
  std::int64_t at;
  std::int64_t work;
  std::uint32_t vertex;
};

/// For a heap whose top is the earliest path, of equals the one with more work.
bool later(const Path& a, const Path& b) { return a.at != b.at ? a.at > b.at : a.work < b.work; }

/// Rounding of sums of nanoseconds in double stays below this.
constexpr double kTolerance = 1e-3;

/// Longest paths when each ns that passes pays `rate`; finds a cycle that still gains, if any.
class Relaxation {
 public:
  Relaxation(const Arcs& arcs, const Costs& costs, double rate)
      : arcs_(arcs), costs_(costs), rate_(rate), longest_(costs.begin(), costs.end()) {
    before_.assign(costs.size(), kNone);
    std::size_t rounds = 0;
    while (relax()) {
      if (++rounds <= costs.size()) continue;
      endless_ = true;
      break;
    }
  }

  /// Some cycle gains.
  [[nodiscard]] bool endless() const { return endless_; }
  [[nodiscard]] double longest() const {
    return *std::max_element(longest_.begin(), longest_.end());
  }
  /// Of a cycle that gains: its work for each ns.
  [[nodiscard]] double ratio() const {
    std::size_t at = last_;
    for (std::size_t i = 0; i < costs_.size(); ++i) at = before_[at];  // surely on the cycle now
    double work = 0;
    double time = 0;
    const std::size_t start = at;
    do {
      const std::size_t from = before_[at];
      work += static_cast<double>(costs_[at]);
      time += static_cast<double>(separation(from, at));
      at = from;
    } while (at != start);
    return work / time;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  bool relax() {
    bool changed = false;
    for (std::size_t from = 0; from < costs_.size(); ++from) {
      for (const Arcs::Arc* arc = arcs_.begin(from); arc != arcs_.end(from); ++arc) {
        const double length = longest_[from] + static_cast<double>(costs_[arc->to]) -
                              rate_ * static_cast<double>(arc->separation);
        if (length <= longest_[arc->to] + kTolerance) continue;
        longest_[arc->to] = length;
        before_[arc->to] = from;
        last_ = arc->to;
        changed = true;
      }
    }
    return changed;
  }
  [[nodiscard]] std::int64_t separation(std::size_t from, std::size_t to) const {
    std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
    for (const Arcs::Arc* arc = arcs_.begin(from); arc != arcs_.end(from); ++arc) {
      if (arc->to == to) shortest = std::min(shortest, arc->separation);
    }
    return shortest;
  }

  const Arcs& arcs_;
  const Costs& costs_;
  const double rate_;
  std::vector<double> longest_;
  std::vector<std::size_t> before_;
  std::size_t last_ = 0;
  bool endless_ = false;
};

}  // namespace

Steps request_bound(const Arcs& arcs, const Costs& costs, std::int64_t horizon) {
  std::vector<std::int64_t> best(costs.size(), -1);
  std::vector<Path> heap;
  for (std::uint32_t vertex = 0; vertex < costs.size(); ++vertex) {
    heap.push_back({0, costs[vertex], vertex});
  }
  std::make_heap(heap.begin(), heap.end(), later);
  Steps steps;
  while (!heap.empty()) {
    const Path path = heap.front();
    std::pop_heap(heap.begin(), heap.end(), later);
    heap.pop_back();
    if (path.work <= best[path.vertex]) continue;  // an earlier path had as much
    best[path.vertex] = path.work;
    if (steps.empty() || path.work > steps.back().total) steps.push_back({path.at, path.work});
    for (const Arcs::Arc* arc = arcs.begin(path.vertex); arc != arcs.end(path.vertex); ++arc) {
      const Path next{path.at + arc->separation, path.work + costs[arc->to], arc->to};
      if (next.at >= horizon || next.work <= best[arc->to]) continue;
      heap.push_back(next);
      std::push_heap(heap.begin(), heap.end(), later);
    }
  }
  return steps;
}

Cover cover(const Arcs& arcs, const Costs& costs) {
  if (costs.empty()) return {};
  double rate = 0;
  for (;;) {
    const Relaxation relaxation(arcs, costs, rate);
    if (!relaxation.endless()) return {relaxation.longest() + 1, rate};
    const double ratio = relaxation.ratio();
    // A cycle that only gains by rounding ends the search; a bit of rate makes up for it.
    rate = ratio > rate ? ratio : rate * (1 + 1e-12);
  }
}

}  // namespace mauve::analysis
