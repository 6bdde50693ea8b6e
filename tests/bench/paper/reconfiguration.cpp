// SPDX-License-Identifier: LGPL-3.0-or-later
/// Table 4 and Fig. 9: B requests in its job that A gets another core, which computes for another
/// time. A thread beside them looks for requests and carries them out, as the daemon does.
#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench/paper/experiments.h"
#include "bench/paper/tasks.h"
#include "bench/support/checked.h"
#include "bench/support/raw.h"

#include <mauve/detail/class_name.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/request.h>

namespace bench::paper {
namespace {

constexpr int kEvery = 2;  // jobs of B between two requests
constexpr Duration kLong{250ms};

/// The events that the threads of the tasks note; they are read when these threads have ended.
struct Notes {
  struct Job {
    Instant start;
    Instant end;
    int core;
  };
  std::vector<Job> a;
  std::vector<Cycle> b;
  std::vector<double> asking;  // ns of B's job
  int every = kEvery;
  int jobs = 0;
  Cycle configured{};

  void clear(int between) {
    a.clear();
    b.clear();
    asking.clear();
    a.reserve(4096);
    b.reserve(4096);
    asking.reserve(4096);
    every = between;
    jobs = 0;
    configured = {};
  }
};
Notes& notes() {
  static Notes all;
  return all;
}

/// The contract of A.
struct Work : mauve::Core<mauve::EmptyShell> {
  using Contract = Work;
  static constexpr const char* contract = "paper/task/1";
  mauve::Stateless stateless{*this};
  virtual void update() = 0;
};
template <int Number, int Milliseconds>
struct Version : Work {
  void update() override {
    const Instant start = now();
    compute(std::chrono::milliseconds(Milliseconds));
    notes().a.push_back({start, now(), Number});
  }
};
using First = Version<1, 20>;
using Second = Version<2, 15>;
/// As if it opened a device, or made large tables.
struct Slow final : Version<2, 15> {
  mauve::Status on_configure() override {
    notes().configured.start = now();
    compute(kLong);
    notes().configured.end = now();
    return mauve::ok();
  }
};

/// B's part.
void ask_sometimes() {
  Notes& all = notes();
  if (++all.jobs % all.every != 0) return;
  const Instant before = now();
  must_hold(mauve::request("other core of a"), "a request was refused");
  all.asking.push_back(static_cast<double>(now() - before));
}
struct Asking : mauve::Core<mauve::EmptyShell> {
  mauve::Stateless stateless{*this};
  void update() {
    const Instant start = now();
    ask_sometimes();
    compute(kB.time);
    notes().b.push_back({start, now()});
  }
};

struct SwappedPair : mauve::Architecture {
  explicit SwappedPair(int cpu) {
    a.fsm().period = kA.period;
    a.task().priority = kA.priority;
    a.task().cpus = {cpu};
    b.fsm().period = kB.period;
    b.task().priority = kB.priority;
    b.task().cpus = {cpu};
  }
  mauve::Component<mauve::EmptyShell, First, mauve::PeriodicFsm<Work>> a{*this, "a"};
  mauve::Component<mauve::EmptyShell, Asking, mauve::PeriodicFsm<Asking>> b{*this, "b"};
};

struct Result {
  std::vector<double> pause;   // ns of A
  std::vector<double> asking;  // ns of B
  std::vector<double> across;  // ms between the starts of A's jobs before and after
  std::uint64_t missed = 0;
  std::size_t apart = 0;

  void add(const Result& other) {
    pause.insert(pause.end(), other.pause.begin(), other.pause.end());
    asking.insert(asking.end(), other.asking.begin(), other.asking.end());
    across.insert(across.end(), other.across.begin(), other.across.end());
    missed += other.missed;
    apart += other.apart;
  }
};

void take_notes(int cpu, const Probe& probe, Result& into) {
  into.asking = notes().asking;
  const auto& jobs = notes().a;
  for (std::size_t i = 1; i < jobs.size(); ++i) {
    if (jobs[i].core == jobs[i - 1].core) continue;
    if (probe.disturbed(cpu, jobs[i - 1].start, jobs[i].start)) {
      ++into.apart;
    } else {
      into.across.push_back(static_cast<double>(jobs[i].start - jobs[i - 1].start) / 1e6);
    }
  }
}

/// Until B has requested something.
void await(mauve::Deployer& deployer) {
  for (bool requested = false; !requested; std::this_thread::sleep_for(200us)) {
    deployer.drain([&](const mauve::RuntimeEvent& one) { requested |= one.event == "requested"; });
  }
}

Result swaps_by_mauve(Places places, int count) {
  notes().clear(kEvery);
  SwappedPair architecture(places.component);
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  tie_ticks();
  Result result;
  const Probe probe(deployer.t0() + 1'000'000, 2ms);
  {
    const OnCpu here(places.coordinator, 0);
    for (int i = 0; i < count; ++i) {
      await(deployer);
      const mauve::Receipt receipt =
          checked(i % 2 == 0 ? deployer.swap_core<Second>("a") : deployer.swap_core<First>("a"));
      result.pause.push_back(static_cast<double>(receipt.components[0].pause.count()));
      result.missed += receipt.components[0].missed;
    }
  }
  std::this_thread::sleep_for(kA.period);
  static_cast<void>(deployer.shutdown());
  take_notes(places.component, probe, result);
  return result;
}

/// Two loops on one reference; B stores a pointer, A takes it when it wakes.
Result swaps_by_raw(Places places, int count) {
  notes().clear(kEvery);
  static const std::array<int, 2> cores{1, 2};
  std::atomic<const int*> pending{nullptr};
  const int* current = cores.data();
  Result result;
  result.pause.reserve(4096);
  const Instant t0 = now() + 5'000'000;
  const Probe probe(t0 + 1'000'000, 2ms);
  {
    const RawLoop a(places.component, fifo_or_none(kA.priority), t0, kA.period, [&](Instant woke) {
      if (pending.load(std::memory_order_acquire) != nullptr) {
        const Instant before = now();
        current = pending.exchange(nullptr, std::memory_order_acq_rel);
        result.pause.push_back(static_cast<double>(now() - before));
      }
      compute(*current == 1 ? 20ms : 15ms);
      notes().a.push_back({woke, now(), *current});
    });
    const RawLoop b(places.component, fifo_or_none(kB.priority), t0, kB.period, [&](Instant woke) {
      if (++notes().jobs % kEvery == 0) {
        const Instant before = now();
        pending.store(&cores[static_cast<std::size_t>(notes().jobs / kEvery) % 2],
                      std::memory_order_release);
        notes().asking.push_back(static_cast<double>(now() - before));
      }
      compute(kB.time);
      notes().b.push_back({woke, now()});
    });
    std::this_thread::sleep_for(kEvery * kB.period * count + kB.period);
  }
  take_notes(places.component, probe, result);
  return result;
}

void table_4(Book& book, const Setting& setting) {
  const Places places{setting.cpu, mauve::rt::usable_cpus().front()};
  const int rounds = setting.options.choose(5, 1);
  const int count = setting.options.choose(20, 2);
  Result mauve;
  Result raw;
  for (int i = 0; i < rounds; ++i) {
    mauve.add(swaps_by_mauve(places, count));
    raw.add(swaps_by_raw(places, count));
  }
  std::vector<Row> rows{{"paper: MAUVE", "196 (mean), sd 16", "", "196 (mean)", "99.999", "0.057"}};
  const auto add = [&](const std::string& name, const Result& of) {
    const Statistics pause = statistics(of.pause);
    const Statistics across = statistics(of.across);
    const std::string asking = ms(statistics(of.asking).middle / 1000);
    rows.push_back({name, ms(pause.middle / 1000), ms(pause.p99 / 1000), asking, ms(across.mean),
                    ms(across.deviation)});
  };
  add("**mauve**", mauve);
  add("**raw POSIX**, a pointer", raw);
  const Row head{"", "pause of A, us, median", "p99", "B's part", "A's period across, ms", "sd"};
  book.table("Table 4: B reconfigures A", head, rows);
  book.csv("table4", head, rows);
  book.text(
      std::to_string(mauve.pause.size()) + " swaps by mauve, " + std::to_string(mauve.missed) +
      " releases missed; " + std::to_string(mauve.apart) + " (raw: " + std::to_string(raw.apart) +
      ") periods across were disturbed and left out. In the paper B itself does it, and A "
      "stands still meanwhile; here B makes a request, a thread beside them makes and configures "
      "the core, and A pauses at a boundary.");
  const double pause = statistics(mauve.pause).middle;
  book.goal("Table 4, pause of A, median", "196 us / 1000 = 196 ns", ns(pause) + " ns",
            pause <= 196);
  const double apart = statistics(mauve.across).mean - 100.0;
  book.goal("Table 4, period of A across the swap, mean", "100 ms +- 0.1 ms",
            ms(apart + 100.0) + " ms", apart > -0.1 && apart < 0.1);
}

/// A run in which making A's next core takes longer than two periods; for the plot.
void figure_9(Book& book, const Setting& setting, bool in_place) {
  const Places places{setting.cpu, mauve::rt::usable_cpus().front()};
  notes().clear(4);
  SwappedPair architecture(places.component);
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  {
    const OnCpu here(places.coordinator, 0);
    await(deployer);
    mauve::Edit edit;
    edit.member = "a";
    edit.core = mauve::CoreType::of<Slow>(mauve::class_name(typeid(Slow)));
    mauve::Change change;
    change.edits.push_back(edit);
    const auto done = in_place ? deployer.swap_core_in_place(edit) : deployer.apply(change);
    static_cast<void>(checked(done));
  }
  std::this_thread::sleep_for(4 * kA.period);
  static_cast<void>(deployer.shutdown());
  const auto since = [&](Instant instant) {
    return ms(static_cast<double>(instant - deployer.t0()) / 1e6);
  };
  std::vector<Row> rows;
  std::size_t most = 0;  // periods without a job of A
  for (std::size_t i = 0; i < notes().a.size(); ++i) {
    const Notes::Job& job = notes().a[i];
    rows.push_back({"a", std::to_string(job.core), since(job.start), since(job.end)});
    if (i == 0) continue;
    const Instant gap = job.start - notes().a[i - 1].start;
    most = std::max(
        most, static_cast<std::size_t>((gap + kA.period.count() / 2) / kA.period.count()) - 1);
  }
  for (const Cycle& job : notes().b) rows.push_back({"b", "1", since(job.start), since(job.end)});
  rows.push_back(
      {"configure", "2", since(notes().configured.start), since(notes().configured.end)});
  book.csv(in_place ? "figure9_in_place" : "figure9", {"row", "core", "start_ms", "end_ms"}, rows);
  book.text(std::string(in_place ? "- the paper's way, A stands still (`in place`): "
                                 : "- beside the running core: ") +
            "A left out " + std::to_string(most) + " releases while its next core was configured " +
            "for 250 ms of processor time, and went on at its own releases.");
}

}  // namespace

void measure_reconfiguration(Book& book, const Setting& setting) {
  table_4(book, setting);
  book.text("Fig. 9: a long reconfiguration (plots `figure9.svg`, `figure9_in_place.svg`).");
  figure_9(book, setting, false);
  figure_9(book, setting, true);
}

}  // namespace bench::paper
