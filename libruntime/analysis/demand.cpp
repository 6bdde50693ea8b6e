// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/demand.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mauve::analysis {
namespace {

std::int64_t scaled(Duration time, double factor) {
  if (factor == 1) return time.count();
  return static_cast<std::int64_t>(std::ceil(static_cast<double>(time.count()) * factor));
}

/// How many intervals of `period` have begun within `length`.
std::int64_t begun(std::int64_t length, std::int64_t period) {
  return (length + period - 1) / period;
}

/// Releases may come `jitter` later than they should, so more of them fit into a window.
Steps crowded(const Steps& steps, std::int64_t jitter) {
  if (jitter == 0) return steps;
  Steps result;
  for (const Step& step : steps) {
    const std::int64_t at = std::max<std::int64_t>(step.at - jitter, 0);
    if (!result.empty() && result.back().at == at) result.pop_back();
    result.push_back({at, step.total});
  }
  return result;
}

std::vector<std::int64_t> all_times(const std::vector<Demand>& demands) {
  std::vector<std::int64_t> times;
  for (const Demand& demand : demands) {
    for (const Step& step : demand.steps) times.push_back(step.at);
  }
  return times;
}

}  // namespace

Demand::Demand(const Task& of, const Overheads& overheads, double factor)
    : task(&of), arcs(of.graph) {
  const std::vector<Vertex>& vertices = of.graph.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    costs.push_back(scaled(vertices[i].execution, factor) + overheads.activation.count());
    std::int64_t separation = std::numeric_limits<std::int64_t>::max();
    for (const Arcs::Arc* arc = arcs.begin(i); arc != arcs.end(i); ++arc) {
      separation = std::min(separation, arc->separation);
    }
    separations.push_back(separation);
    deadlines.push_back(std::min(vertices[i].deadline.count(), separation));
  }
  line = cover(arcs, costs);
  line.burst += line.rate * static_cast<double>(of.jitter.count());
  jobs = cover(arcs, Costs(vertices.size(), 1));
}

void Demand::unroll(std::int64_t horizon) {
  const std::int64_t jitter = task->jitter.count();
  steps = crowded(request_bound(arcs, costs, horizon + jitter), jitter);
}

std::int64_t Demand::work_within(std::int64_t length) const {
  const std::int64_t window = length + task->jitter.count();
  return value(request_bound(arcs, costs, window), window);
}

Kernel::Kernel(const std::vector<Demand>& demands, const Overheads& overheads)
    : overheads_(overheads) {
  for (const Demand& demand : demands) {
    grid_ = std::gcd(grid_, demand.task->offset.count());
    for (const Edge& edge : demand.task->graph.edges) {
      grid_ = std::gcd(grid_, edge.separation.count());
    }
    jobs_ += demand.jobs;
  }
  grid_ = std::max<std::int64_t>(grid_, 1);
}

void Kernel::unroll(const std::vector<Demand>& demands, std::int64_t horizon) {
  if (overheads_.interrupt == 0ns || jobs_.rate * static_cast<double>(grid_) >= 1) return;
  std::vector<Steps> counts;
  for (const Demand& demand : demands) {
    counts.push_back(request_bound(demand.arcs, Costs(demand.costs.size(), 1), horizon));
  }
  std::vector<const Steps*> parts;
  for (const Steps& steps : counts) parts.push_back(&steps);
  expiries_ = sum(parts);
  counted_ = horizon;
}

std::int64_t Kernel::work_within(std::int64_t length) const {
  std::int64_t expiries = begun(length, grid_);
  if (length <= counted_) {
    expiries = std::min(expiries, value(expiries_, length));
  } else {
    const double most = jobs_.value(static_cast<double>(length));
    if (most < static_cast<double>(expiries)) expiries = static_cast<std::int64_t>(most) + 1;
  }
  return overheads_.interrupt.count() * expiries +
         overheads_.tick.count() * begun(length, overheads_.tick_period.count());
}

Cover Kernel::line() const {
  const double per_grid = 1 / static_cast<double>(grid_);
  const Cover expiries = jobs_.rate < per_grid ? jobs_ : Cover{1, per_grid};
  const auto interrupt = static_cast<double>(overheads_.interrupt.count());
  const auto tick = static_cast<double>(overheads_.tick.count());
  const auto period = static_cast<double>(overheads_.tick_period.count());
  return {expiries.burst * interrupt + tick, expiries.rate * interrupt + tick / period};
}

Interference::Interference(const std::vector<Demand>& demands, const Kernel& kernel,
                           std::int64_t horizon, bool in_turn)
    : kernel_(kernel), horizon_(horizon), in_turn_(in_turn), together_(all_times(demands)) {}

void Interference::include(const Demand& demand) {
  if (phased(demand)) {
    (demand.task->presence == Presence::before ? before_ : after_).demands.push_back(&demand);
    change_known_ = false;
    return;
  }
  together_.add(demand.steps);
  together_line_ += demand.line;
}

void Interference::look_from(const Demand& demand) {
  own_ = &demand;
  if (change_known_ && !phased(demand)) return;
  const Steps old = before_.steps_without(own_);
  change_ = one_after_the_other(one_after_the_other(old, after_.steps_without(own_), horizon_), old,
                                horizon_);
  change_known_ = !phased(demand);
}

std::int64_t Interference::work_within(std::int64_t length) const {
  std::int64_t work = together_.value(length) + kernel_.work_within(length);
  if (!change_.empty()) work += value(change_, length);
  if (own_ != nullptr && !phased(*own_)) work -= value(own_->steps, length);
  return work;
}

Cover Interference::line() const {
  Cover line = together_line_;
  if (own_ != nullptr && !phased(*own_)) {
    line.burst -= own_->line.burst;
    line.rate -= own_->line.rate;
  }
  const Cover old = before_.line_without(own_);
  const Cover fresh = after_.line_without(own_);
  line += {2 * old.burst + fresh.burst, std::max(old.rate, fresh.rate)};
  return line += kernel_.line();
}

Steps Interference::Phase::steps_without(const Demand* own) const {
  std::vector<const Steps*> parts;
  for (const Demand* demand : demands) {
    if (demand != own) parts.push_back(&demand->steps);
  }
  return sum(parts);
}

Cover Interference::Phase::line_without(const Demand* own) const {
  Cover line;
  for (const Demand* demand : demands) {
    if (demand != own) line += demand->line;
  }
  return line;
}

}  // namespace mauve::analysis
