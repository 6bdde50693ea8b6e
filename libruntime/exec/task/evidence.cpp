// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/evidence.h"

#include <algorithm>
#include <bit>

namespace mauve::exec {
namespace {

unsigned count(std::uint64_t jobs, std::uint64_t window) {
  return static_cast<unsigned>(std::popcount(jobs & window));
}

}  // namespace

Evidence::Verdict Evidence::weigh(const JobTiming& job, const Rules& rules) {
  const int weight = job.over_budget ? kWeight : -1;
  sum_ = std::max(0, sum_ + weight);
  weighted_ = std::max(0, weighted_ + (job.twice_over ? kDoubleWeight : weight));
  too_long_ = too_long_ << 1U | (job.too_long ? 1U : 0U);
  note(job.late);
  const unsigned tolerated = std::max(rules.tolerated, 1U);  // one job is no evidence
  const unsigned excused = count(~0ULL, rules.window) * kExcusedOf64 / 64;
  const unsigned as_before = std::min(2 * count(late_before_, rules.window), kMostAsBefore);
  const bool too_long = job.too_long && count(too_long_, rules.window) > tolerated;
  const bool starved = job.late && count(late_, rules.window) > tolerated + excused + as_before;
  if (too_long || starved) return Verdict::overruns;
  const bool enough = sum_ >= kJobs * kWeight || weighted_ >= kDoubleJobs * kDoubleWeight;
  return job.over_budget && enough ? Verdict::over_budget : Verdict::none;
}

}  // namespace mauve::exec
