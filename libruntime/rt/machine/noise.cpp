// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/machine/noise.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>

namespace mauve::rt {
namespace {

std::size_t configured_cpus() {
  const long count = sysconf(_SC_NPROCESSORS_CONF);
  return count > 0 ? static_cast<std::size_t>(count) : 1;
}

/// Both blocks as one distribution; buckets of one histogram have the same limits as those of
/// another.
void merge(Distribution& all, const Distribution& more) {
  if (more.count == 0) return;
  all.min = all.count == 0 ? more.min : std::min(all.min, more.min);
  all.max = std::max(all.max, more.max);
  all.count += more.count;
  all.sum += more.sum;
  for (const Distribution::Bucket& bucket : more.buckets) {
    const auto place = std::lower_bound(
        all.buckets.begin(), all.buckets.end(), bucket,
        [](const auto& left, const auto& right) { return left.from < right.from; });
    if (place != all.buckets.end() && place->from == bucket.from) {
      place->count += bucket.count;
    } else {
      all.buckets.insert(place, bucket);
    }
  }
}

}  // namespace

/// The older block is cleared and becomes the current one.
void NoiseOfCpu::turn_over(Instant now) {
  const std::size_t current = current_.load(std::memory_order_relaxed);
  const Instant since = blocks_[current].since.load(std::memory_order_relaxed);
  if (since != 0 && now - since < kBlock.count()) return;
  Block& next = since == 0 ? blocks_[current] : blocks_[1 - current];
  next.late.clear();
  next.beyond.store(0, std::memory_order_relaxed);
  next.since.store(now, std::memory_order_relaxed);
  if (since != 0) current_.store(1 - current, std::memory_order_release);
}

void NoiseOfCpu::add(Instant due, Instant ran) {
  turn_over(ran);
  Block& block = blocks_[current_.load(std::memory_order_relaxed)];
  const Instant late = ran - due;
  block.late.add(late);
  if (late > assumed_.count()) {
    block.beyond.store(block.beyond.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  if (late > worst_.load(std::memory_order_relaxed)) {
    worst_.store(late, std::memory_order_relaxed);
    worst_at_.store(ran, std::memory_order_relaxed);
  }
  if (late > late_.count()) {
    late_by_.store(late, std::memory_order_relaxed);
    late_at_.store(ran, std::memory_order_release);
  }
  ran_at_.store(ran, std::memory_order_relaxed);
}

WakeNoise NoiseOfCpu::look(Instant now) const {
  WakeNoise seen;
  Instant oldest = now;
  for (const Block& block : blocks_) {
    const Instant since = block.since.load(std::memory_order_relaxed);
    if (since == 0) continue;
    oldest = std::min(oldest, since);
    // A wake-up is counted in `late` first, so this order never shows more of them in `beyond`.
    const std::uint64_t beyond = block.beyond.load(std::memory_order_acquire);
    const Distribution late = block.late.look();
    seen.beyond += std::min(beyond, late.count);  // the block may have been cleared in between
    merge(seen.late, late);
  }
  seen.span = Duration{now - oldest};
  seen.worst = Duration{worst_.load(std::memory_order_relaxed)};
  const Instant worst_at = worst_at_.load(std::memory_order_relaxed);
  seen.worst_ago = worst_at == 0 ? Duration{0} : Duration{now - worst_at};
  return seen;
}

Noise::Noise(Duration assumed) : assumed_(assumed), cpus_(configured_cpus()) {}

Noise::~Noise() { stop(); }

void Noise::stop() { probes_.clear(); }

void Noise::watch(const std::vector<int>& cpus) {
  for (const int cpu : cpus.empty() ? usable_cpus() : cpus) {
    const auto index = static_cast<std::size_t>(cpu);
    if (cpu < 0 || index >= cpus_.size() || find(cpu) != nullptr) continue;
    auto noise = std::make_unique<NoiseOfCpu>(assumed_);
    auto probe = std::make_unique<Probe>(
        cpu, kPeriod, [&its = *noise](Instant due, Instant ran) { its.add(due, ran); });
    if (!probe->start()) continue;
    cpus_[index].store(noise.get(), std::memory_order_release);
    owned_.push_back(std::move(noise));
    probes_.push_back(std::move(probe));
  }
}

const NoiseOfCpu* Noise::find(int cpu) const {
  const auto index = static_cast<std::size_t>(cpu);
  if (cpu < 0 || index >= cpus_.size()) return nullptr;
  return cpus_[index].load(std::memory_order_acquire);
}

Duration Noise::held_up_since(Instant instant) const {
  const NoiseOfCpu* const noise = find(sched_getcpu());
  return noise == nullptr ? Duration{0} : noise->held_up_since(instant);
}

bool Noise::is_known() const {
  const NoiseOfCpu* const noise = find(sched_getcpu());
  return noise != nullptr && noise->ran_at() != 0;
}

bool Noise::stands_still(const std::vector<int>& cpus, Instant now) const {
  return std::any_of(cpus.begin(), cpus.end(), [&](int cpu) {
    const NoiseOfCpu* const noise = find(cpu);
    const Instant ran = noise == nullptr ? 0 : noise->ran_at();
    return ran != 0 && now - ran > 2 * kPeriod.count();
  });
}

std::vector<WakeNoise> Noise::look(Instant now) const {
  std::vector<WakeNoise> rows;
  for (std::size_t cpu = 0; cpu < cpus_.size(); ++cpu) {
    const NoiseOfCpu* const noise = cpus_[cpu].load(std::memory_order_acquire);
    if (noise == nullptr) continue;
    rows.push_back(noise->look(now));
    rows.back().cpu = static_cast<int>(cpu);
  }
  return rows;
}

}  // namespace mauve::rt
