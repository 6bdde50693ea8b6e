// SPDX-License-Identifier: LGPL-3.0-or-later
/// 1 to 1000 transactions a second over four components of 1 kHz, each of which gets another core.
#include <algorithm>
#include <array>
#include <string>
#include <thread>

#include <time.h>

#include "bench/scale/sweeps.h"
#include "bench/support/checked.h"
#include "bench/support/counting.h"
#include "bench/support/machine.h"
#include "bench/support/sweep.h"

#include <mauve/host/deployer.h>

namespace bench::scale {
namespace {

constexpr int kMembers = 4;
constexpr Duration kMembersPeriod{1'000'000};

Instant thread_time() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<Instant>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

struct Done {
  struct Transaction {
    Instant from;
    Instant to;
    std::uint64_t missed;
  };
  std::vector<Transaction> all;
  std::vector<double> pauses;  // ns, of each member
  double seconds = 0;
  double coordinator = 0;  // ms of its processor time
};

/// Begins one at each instant of a grid; what comes too late begins at once, and is not made up
/// for.
Done transactions(mauve::Deployer& deployer, const CountingMany& members, int rate, Duration time) {
  const std::array<mauve::Change, 2> changes{members.to<1>(), members.to<2>()};
  Done done;
  const Instant begun = now();
  const Instant busy = thread_time();
  const Instant apart = 1'000'000'000 / rate;
  for (Instant due = begun; due < begun + time.count(); due = std::max(due + apart, now())) {
    std::this_thread::sleep_for(Duration{due - now()});
    const Instant from = now();
    const auto receipt = checked(deployer.apply(changes[1 - done.all.size() % 2]));
    std::uint64_t missed = 0;
    for (const mauve::MemberReceipt& member : receipt.components) {
      done.pauses.push_back(static_cast<double>(member.pause.count()));
      missed += member.missed;
    }
    done.all.push_back({from, now(), missed});
    deployer.drain([](const mauve::RuntimeEvent&) {});
  }
  done.coordinator = static_cast<double>(thread_time() - busy) / 1e6;
  done.seconds = static_cast<double>(std::max(now() - begun, time.count())) / 1e9;
  return done;
}

bool disturbed(const Probe& probe, const Done::Transaction& one) {
  for (const int cpu : mauve::rt::usable_cpus()) {
    if (probe.disturbed(cpu, one.from, one.to)) return true;
  }
  return false;
}

void measure(Sweep& sweep, int rate, Duration time) {
  CountingMany architecture(kMembers, kMembersPeriod);
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  const Probe probe(deployer.t0() + kMembersPeriod.count() / 4);
  std::this_thread::sleep_for(20 * kMembersPeriod);
  const Done done = transactions(deployer, architecture, rate, time);
  std::this_thread::sleep_for(2 * Probe::kPeriod);
  static_cast<void>(deployer.shutdown());
  double missed = 0;
  double apart = 0;
  for (const auto& one : done.all) {
    (disturbed(probe, one) ? apart : missed) += static_cast<double>(one.missed);
  }
  const auto count = static_cast<double>(done.all.size());
  sweep.add(rate,
            {count / done.seconds, done.coordinator / done.seconds, 1000 * done.coordinator / count,
             median(done.pauses), percentile(done.pauses, 99), missed, apart});
}

}  // namespace

void sweep_transactions(Book& book, const Options& options) {
  const Duration time = std::chrono::milliseconds(options.choose(3000, 300));
  Sweep sweep("transactions",
              "Transactions over " + std::to_string(kMembers) + " components of 1 kHz",
              "asked for, 1/s",
              {{"reached, 1/s", "1/s for each asked for"},
               {"coordinator busy, ms a second", "ms a transaction"},
               {"coordinator, us each", ""},
               {"pause of a member, p50, ns", "ns for 1/s more"},
               {"p99, ns", "ns for 1/s more"},
               {"releases missed", "", true},
               {"missed while disturbed", "", true}});
  for (int round = 0; round < options.rounds; ++round) {
    for (const int rate : {1, 10, 100, 1000}) measure(sweep, rate, time);
  }
  sweep.print(book);
  book.text(
      "A transaction is prepared, takes effect at one instant some 0.2 ms ahead, and ends when the "
      "last member is in force, up to a period later; the next one begins after that. What a "
      "transaction costs the coordinator is the slope of its busy time. Pauses at a low rate are "
      "those of cold caches. Disturbed: a SCHED_FIFO 99 probe was itself over 200 us late.");
}

}  // namespace bench::scale
