// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/steps.h"

#include <algorithm>

namespace mauve::analysis {
namespace {

bool earlier(const Step& a, const Step& b) { return a.at < b.at; }

/// Joins increments at the same time and sums them up.
Steps accumulated(Steps increments) {
  std::sort(increments.begin(), increments.end(), earlier);
  Steps result;
  std::int64_t total = 0;
  for (const Step& increment : increments) {
    total += increment.total;
    if (!result.empty() && result.back().at == increment.at) {
      result.back().total = total;
    } else {
      result.push_back({increment.at, total});
    }
  }
  return result;
}

}  // namespace

std::int64_t value(const Steps& steps, std::int64_t length) {
  const auto after = std::lower_bound(steps.begin(), steps.end(), Step{length, 0}, earlier);
  return after == steps.begin() ? 0 : std::prev(after)->total;
}

Steps sum(const std::vector<const Steps*>& parts) {
  Steps increments;
  for (const Steps* part : parts) {
    std::int64_t total = 0;
    for (const Step& step : *part) {
      increments.push_back({step.at, step.total - total});
      total = step.total;
    }
  }
  return accumulated(std::move(increments));
}

Steps one_after_the_other(const Steps& first, const Steps& then, std::int64_t horizon) {
  if (first.empty()) return then;
  Steps all = first;
  all.insert(all.end(), then.begin(), then.end());
  for (const Step& a : first) {
    for (const Step& b : then) {
      if (a.at + b.at >= horizon) break;
      all.push_back({a.at + b.at, a.total + b.total});
    }
  }
  std::sort(all.begin(), all.end(), [](const Step& a, const Step& b) {
    return a.at != b.at ? a.at < b.at : a.total > b.total;
  });
  Steps result;
  for (const Step& step : all) {
    if (result.empty() || step.total > result.back().total) result.push_back(step);
  }
  return result;
}

StepSum::StepSum(std::vector<std::int64_t> times) : times_(std::move(times)) {
  std::sort(times_.begin(), times_.end());
  times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
  tree_.assign(times_.size() + 1, 0);
}

void StepSum::add(const Steps& steps) {
  std::int64_t total = 0;
  auto from = times_.begin();
  for (const Step& step : steps) {
    from = std::lower_bound(from, times_.end(), step.at);
    const std::size_t index = static_cast<std::size_t>(from - times_.begin()) + 1;
    for (std::size_t i = index; i < tree_.size(); i += i & (~i + 1)) tree_[i] += step.total - total;
    total = step.total;
  }
}

std::int64_t StepSum::value(std::int64_t length) const {
  const auto after = std::lower_bound(times_.begin(), times_.end(), length);
  std::int64_t total = 0;
  for (auto i = static_cast<std::size_t>(after - times_.begin()); i > 0; i &= i - 1) {
    total += tree_[i];
  }
  return total;
}

}  // namespace mauve::analysis
