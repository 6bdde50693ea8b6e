// SPDX-License-Identifier: LGPL-3.0-or-later
#include "doctor/wake.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "mauve/host/clock.h"
#include "render/table.h"
#include "render/words.h"
#include "rt/thread/futex.h"
#include "rt/thread/thread.h"

namespace mauve::ctl::doctor {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kPeriod = 1'000'000;
constexpr std::int64_t kUsual = 100'000;    // p99 of a machine that is fit for 1 kHz
constexpr std::int64_t kWorst = 1'000'000;  // a whole period of 1 kHz
constexpr std::size_t kBar = 40;

/// The upper ends of the rows of the histogram, in ns.
constexpr std::int64_t kRows[] = {5'000,
                                  10'000,
                                  20'000,
                                  50'000,
                                  100'000,
                                  200'000,
                                  500'000,
                                  1'000'000,
                                  2'000'000,
                                  5'000'000,
                                  std::numeric_limits<std::int64_t>::max()};

/// Sleeps from instant to instant; instants that passed during a sleep are left out.
void sleep_and_look(Wakes& wakes) {
  const MonotonicClock clock;
  const std::atomic<std::uint32_t> nobody_bumps_it{0};
  Instant due = clock.now() + kPeriod;
  for (std::int64_t& late : wakes.late_ns) {
    Instant now = clock.now();
    for (; now < due; now = clock.now()) rt::futex_wait_until(nobody_bumps_it, 0, due);
    late = now - due;
    due += (late / kPeriod + 1) * kPeriod;
  }
}

std::vector<std::size_t> rows_of(const std::vector<Wakes>& all) {
  std::vector<std::size_t> rows(std::size(kRows), 0);
  for (const Wakes& wakes : all) {
    for (const std::int64_t late : wakes.late_ns) {
      const auto row = std::lower_bound(std::begin(kRows), std::end(kRows), late);
      ++rows[static_cast<std::size_t>(row - std::begin(kRows))];
    }
  }
  return rows;
}

std::string row_name(std::size_t row) {
  if (row + 1 < std::size(kRows)) {
    return "to " + nanoseconds_in_words(static_cast<double>(kRows[row]));
  }
  return "above";
}

/// The longest bar is that of the largest count; one wake-up is seen as well.
std::string histogram(const std::vector<Wakes>& all, Look look) {
  const auto rows = rows_of(all);
  const std::size_t largest = *std::max_element(rows.begin(), rows.end());
  const std::size_t room = look.width == 0 ? kBar : std::min(kBar, look.width / 2);
  Table table({{"LATE", true}, {"WAKE-UPS", true}, {""}});
  std::size_t last = rows.size();
  while (last > 1 && rows[last - 1] == 0) --last;
  for (std::size_t row = 0; row < last; ++row) {
    const std::size_t bar = (rows[row] * room + largest - 1) / std::max<std::size_t>(largest, 1);
    table.add({{row_name(row)}, {std::to_string(rows[row])}, {std::string(bar, '#')}});
  }
  return table.text(look.width, look.colour);
}

bool all_fifo(const std::vector<Wakes>& all) {
  return std::all_of(all.begin(), all.end(), [](const Wakes& one) { return one.fifo; });
}

std::int64_t worst(const std::vector<Wakes>& all, double percent) {
  std::int64_t longest = 0;
  for (const Wakes& one : all) longest = std::max(longest, one.percentile(percent));
  return longest;
}

std::string time(std::int64_t ns) { return nanoseconds_in_words(static_cast<double>(ns)); }

}  // namespace

std::int64_t Wakes::percentile(double percent) const {
  if (late_ns.empty()) return 0;
  std::vector<std::int64_t> sorted(late_ns);
  std::sort(sorted.begin(), sorted.end());
  const double place = std::ceil(percent / 100 * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(place, 1.0)) - 1];
}

std::vector<Wakes> measure_wakes(std::chrono::nanoseconds time, const std::vector<int>& cpus) {
  struct Sleeper {
    Wakes wakes;
    rt::Thread thread;
  };
  const bool fifo = rt::may_use_fifo(kWakePriority).has_value();
  const auto count = static_cast<std::size_t>(std::max<std::int64_t>(time / 1ms, 1));
  std::vector<std::unique_ptr<Sleeper>> sleepers;
  for (const int cpu : cpus) {
    auto sleeper = std::make_unique<Sleeper>();
    sleeper->wakes = {cpu, fifo, std::vector<std::int64_t>(count)};
    const rt::ThreadAttributes attributes{"mauve-wake", fifo ? kWakePriority : 0, {cpu}};
    Wakes& its = sleeper->wakes;
    if (!sleeper->thread.start(attributes, [&its] { sleep_and_look(its); })) continue;
    sleepers.push_back(std::move(sleeper));
  }
  std::vector<Wakes> all;
  for (auto& sleeper : sleepers) {
    sleeper->thread.join();
    all.push_back(std::move(sleeper->wakes));
  }
  return all;
}

Finding judge_wakes(const std::vector<Wakes>& all) {
  if (all.empty()) return doubt("no thread could be bound to a CPU", "taskset --pid $$");
  const std::int64_t usual = worst(all, 99);
  const std::int64_t longest = worst(all, 100);
  std::string found = "p99 " + time(usual) + ", longest " + time(longest);
  if (!all_fifo(all)) {
    return doubt(found + " of ordinary threads, which says little about real-time ones",
                 "run it as root, or with the rights that `rtprio of you` names");
  }
  const std::string remedy =
      "see the other findings; keep the machine idle to distinguish load from it";
  if (usual > kWorst) return bad(found + ": no release at 1 kHz is kept", remedy);
  if (usual > kUsual) return doubt(found + ": releases at 1 kHz come late", remedy);
  if (longest > kWorst) return doubt(found + ": at 1 kHz releases are lost now and then", remedy);
  return good(found + ": fit for 1 kHz");
}

std::string render_wakes(const std::vector<Wakes>& all, Look look) {
  if (all.empty()) return {};
  Table table(
      {{"CPU", true}, {"POLICY"}, {"WAKE-UPS", true}, {"P50", true}, {"P99", true}, {"MAX", true}});
  for (const Wakes& one : all) {
    table.add({{std::to_string(one.cpu)},
               {one.fifo ? "SCHED_FIFO " + std::to_string(kWakePriority) : "SCHED_OTHER"},
               {std::to_string(one.late_ns.size())},
               {time(one.percentile(50))},
               {time(one.percentile(99))},
               {time(one.percentile(100))}});
  }
  return table.text(look.width, look.colour) + histogram(all, look);
}

Json wakes_json(const std::vector<Wakes>& all) {
  Json cpus = Json::array();
  for (const Wakes& one : all) {
    cpus.push_back({{"cpu", one.cpu},
                    {"fifo", one.fifo},
                    {"count", one.late_ns.size()},
                    {"p50_ns", one.percentile(50)},
                    {"p99_ns", one.percentile(99)},
                    {"max_ns", one.percentile(100)}});
  }
  Json rows = Json::array();
  const auto counts = rows_of(all);
  for (std::size_t row = 0; row < counts.size(); ++row) {
    const bool last = row + 1 == counts.size();
    rows.push_back({{"to_ns", last ? Json() : Json(kRows[row])}, {"count", counts[row]}});
  }
  return {{"cpus", std::move(cpus)}, {"histogram", std::move(rows)}};
}

}  // namespace mauve::ctl::doctor
