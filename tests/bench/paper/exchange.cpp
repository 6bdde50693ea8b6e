// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tables 5 and 6: SharedData through ports against what one would write by hand.
///   sparse     as in the paper: write, 10 ms, read, 10 ms; the caches have forgotten all of it
///   full rate  again and again, alone
///   contended  a writer and a reader at full rate on two CPUs
#include "bench/support/exchange.h"

#include <array>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "bench/paper/experiments.h"
#include "bench/paper/tasks.h"

#include <mauve/deployer.h>

namespace bench::paper {
namespace {

constexpr std::array<std::size_t, 6> kSizes{1, 10, 100, 1000, 10'000, 100'000};
constexpr int kPriority = 50;
constexpr Duration kBetween{10ms};

/// Name of a row: a value for each size, ns.
struct Table {
  std::vector<std::pair<std::string, std::array<double, kSizes.size()>>> rows;

  std::array<double, kSizes.size()>& row(const std::string& name) {
    for (auto& [known, values] : rows) {
      if (known == name) return values;
    }
    return rows.emplace_back(name, std::array<double, kSizes.size()>{}).second;
  }
};

/// Table 5 or 6.
struct Side {
  Table paper;
  Table measured;
};

/// What one way takes when used seldom, ns.
struct Sparse {
  std::vector<double> write;
  std::vector<double> read;
  std::vector<Instant> when;

  Sparse() {
    write.reserve(1 << 12);
    read.reserve(1 << 12);
  }
  /// Alternately.
  template <typename Write, typename Read>
  void step(const Write& writes, const Read& reads) {
    const bool writing = write.size() == read.size();
    static_cast<void>(now());  // so that the clock is at hand for all of them
    const Instant before = now();
    if (writing) {
      writes();
    } else {
      reads();
    }
    (writing ? write : read).push_back(static_cast<double>(now() - before));
  }
};

/// A component with both ports that uses them in turn.
template <typename T>
struct BothShell : mauve::Shell {
  mauve::ReadPort<T> in{*this, "in"};
  mauve::WritePort<T> out{*this, "out"};
};
template <typename T>
struct InTurn : mauve::Core<BothShell<T>> {
  mauve::Stateless stateless{*this};
  Sparse sparse;
  T from{};
  T into{};
  void update() {
    sparse.step([this] { this->shell().out.write(from); },
                [this] { this->shell().in.read(into), touch(&into); });
  }
};
template <typename T>
struct SparseArchitecture : mauve::Architecture {
  explicit SparseArchitecture(int cpu) {
    component.fsm().period = kBetween;
    component.task().priority = kPriority;
    component.task().cpus = {cpu};
  }
  mauve::SharedData<T> data{*this, "data", T{}};
  mauve::Component<BothShell<T>, InTurn<T>, mauve::PeriodicFsm<InTurn<T>>> component{*this,
                                                                                     "component"};
  mauve::Status on_configure() override {
    if (auto done = component.shell().in.connect(data.read_service()); !done) return done;
    return component.shell().out.connect(data.write_service());
  }
};

void add_sparse(const std::string& name, const Sparse& sparse, std::size_t column,
                std::array<Side, 2>& sides) {
  const std::array<const std::vector<double>*, 2> samples{&sparse.write, &sparse.read};
  for (std::size_t i = 0; i < 2; ++i) {
    const Statistics of = statistics(*samples[i]);
    Table& table = sides[i].measured;
    table.row(name + ", sparse, min")[column] = of.least;
    table.row(name + ", sparse, median")[column] = of.middle;
    table.row(name + ", sparse, mean")[column] = of.mean;
    table.row(name + ", sparse, max")[column] = of.most;
  }
}

/// All ways at once on one CPU, a quarter of the time between two uses apart.
template <std::size_t Size>
void measure_sparse(const Setting& setting, std::size_t column, std::array<Side, 2>& sides) {
  using T = Block<Size>;
  const auto ways = std::make_unique<Contenders<Size>>();
  Sparse locked;
  Sparse triple;
  Sparse copied;
  const auto architecture = std::make_unique<SparseArchitecture<T>>(setting.cpu);
  mauve::Deployer deployer(*architecture);
  must(deployer.deploy());
  {
    const int priority = fifo_or_none(kPriority);
    const auto at = [&](int quarter) {
      return deployer.t0() + 10 * kBetween.count() + quarter * kBetween.count() / 4;
    };
    T& from = ways->from;
    T& into = ways->into;
    const RawLoop first(setting.cpu, priority, at(1), kBetween, [&](Instant) {
      locked.step([&] { ways->locked.write(&from); }, [&] { ways->locked.read(&into); });
    });
    const RawLoop second(setting.cpu, priority, at(2), kBetween, [&](Instant) {
      triple.step([&] { ways->triple.write(&from); }, [&] { ways->triple.read(&into); });
    });
    const RawLoop third(setting.cpu, priority, at(3), kBetween, [&](Instant) {
      const auto copy = [&](void* to, const void* data) {
        std::memcpy(to, data, ways->size);
        touch(to);
      };
      copied.step([&] { copy(&ways->other, &from); }, [&] { copy(&into, &ways->other); });
    });
    std::this_thread::sleep_for(setting.options.choose(5000, 250) * 1ms);
  }
  static_cast<void>(deployer.shutdown());
  add_sparse("**mauve**", architecture->component.core().sparse, column, sides);
  add_sparse("PI mutex + memcpy", locked, column, sides);
  add_sparse("triple buffer", triple, column, sides);
  add_sparse("memcpy", copied, column, sides);
}

template <std::size_t Size>
void measure_alone(const Setting& setting, std::size_t column, std::array<Side, 2>& sides) {
  const auto ways = std::make_unique<Contenders<Size>>();
  const std::vector<Operation> operations{
      ways->write(),        ways->read(),        ways->locked_write(), ways->locked_read(),
      ways->triple_write(), ways->triple_read(), ways->copy(),         ways->copy()};
  const int times = Size < 5000 ? 1000 : 50;
  const auto results = alone(operations, times, setting.options.choose(250, 5));
  constexpr std::array names{"**mauve**", "PI mutex + memcpy", "triple buffer", "memcpy"};
  for (std::size_t i = 0; i < results.size(); ++i) {
    sides[i % 2].measured.row(std::string(names[i / 2]) + ", full rate")[column] = results[i];
  }
}

template <std::size_t Size>
void measure_together(const Setting& setting, std::size_t column, std::array<Side, 2>& sides) {
  if (mauve::rt::usable_cpus().size() < 2) return;
  const auto ways = std::make_unique<Contenders<Size>>();
  const int times = Size < 5000 ? 50 : 5;
  constexpr std::array names{"**mauve**", "PI mutex + memcpy", "triple buffer"};
  std::array<std::array<std::vector<double>, 2>, 3> results;
  for (int round = 0; round < setting.options.choose(15, 1); ++round) {
    const std::array measured{together(ways->write(), ways->read(), times),
                              together(ways->locked_write(), ways->locked_read(), times),
                              together(ways->triple_write(), ways->triple_read(), times)};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t side = 0; side < 2; ++side) results[i][side].push_back(measured[i][side]);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      sides[side].measured.row(std::string(names[i]) + ", contended")[column] =
          median(results[i][side]);
    }
  }
}

/// One process with a publisher and a subscriber.
void measure_ros(const Setting& setting, std::size_t column, std::array<Side, 2>& sides) {
  if (setting.ros.empty()) return;
  std::istringstream lines(output_of({setting.ros, "exchange", std::to_string(kSizes[column]),
                                      std::to_string(setting.options.choose(200, 20))},
                                     setting.cpu));
  std::vector<double> published;
  std::vector<double> arrived;
  for (double one = 0, other = 0; lines >> one >> other;) {
    published.push_back(one);
    arrived.push_back(other);
  }
  if (published.empty()) return;
  sides[0].measured.row("roscpp, sparse, publish(), median")[column] = median(published);
  sides[1].measured.row("roscpp, sparse, publish() to callback, median")[column] = median(arrived);
}

template <std::size_t Column>
void measure_size(const Setting& setting, std::array<Side, 2>& sides) {
  measure_alone<kSizes[Column]>(setting, Column, sides);
  measure_together<kSizes[Column]>(setting, Column, sides);
  measure_sparse<kSizes[Column]>(setting, Column, sides);
  measure_ros(setting, Column, sides);
}

void put_paper(std::array<Side, 2>& sides) {
  Table& write = sides[0].paper;
  write.row("paper, sparse, min") = {2088, 1991, 2078, 2670, 7365, 77571};
  write.row("paper, sparse, mean") = {4239, 4034, 4319, 4804, 12874, 120836};
  write.row("paper, sparse, max") = {7856, 8983, 10601, 11947, 35358, 151525};
  Table& read = sides[1].paper;
  read.row("paper, sparse, min") = {2042, 1955, 2167, 2182, 4705, 38280};
  read.row("paper, sparse, mean") = {4037, 3997, 4198, 4367, 9174, 64544};
  read.row("paper, sparse, max") = {11005, 11475, 10961, 10939, 18087, 105324};
  // Medians of one session with the programs of each project, on two virtual CPUs like these.
  write.row("Orocos 2.9 LOCK_FREE, full rate, measured once") = {111, 0, 123, 132, 246, 1750};
  write.row("iceoryx 2.0, full rate, measured once") = {583, 0, 571, 610, 707, 1850};
  read.row("Orocos 2.9 LOCK_FREE, full rate, measured once") = {68, 0, 75, 80, 137, 867};
  read.row("iceoryx 2.0, full rate, measured once") = {162, 0, 168, 179, 248, 910};
}

void print(Book& book, const std::string& title, const std::string& name, Side& side) {
  const Row head{"ns", "1 B", "10 B", "100 B", "1 kB", "10 kB", "100 kB"};
  std::vector<Row> rows;
  for (const Table* table : {&side.paper, &side.measured}) {
    for (const auto& [label, values] : table->rows) {
      Row row{label};
      for (const double value : values) row.push_back(value == 0 ? "" : ns(value));
      rows.push_back(row);
    }
  }
  book.table(title, head, rows);
  book.csv(name, head, rows);
}

/// The size at which ours is worst compared with a limit for each size; 0: no limit there.
void state(Book& book, const std::string& what, const std::string& target,
           const std::array<double, kSizes.size()>& ours,
           const std::array<double, kSizes.size()>& limit) {
  std::size_t worst = 0;
  double most = 0;
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    if (limit[i] == 0 || ours[i] == 0 || ours[i] / limit[i] <= most) continue;
    most = ours[i] / limit[i];
    worst = i;
  }
  if (most == 0) return;
  book.goal(what, target,
            "worst at " + std::to_string(kSizes[worst]) + " B: " + ns(ours[worst]) + " ns of " +
                ns(limit[worst]) + " ns",
            most <= 1);
}

void state_goals(Book& book, const std::string& what, Side& side) {
  const auto times = [](std::array<double, kSizes.size()> values, double factor) {
    for (double& value : values) value *= factor;
    return values;
  };
  Table& all = side.measured;
  const auto& full = all.row("**mauve**, full rate");
  state(book, what + ", full rate", "paper / 25", full,
        times(side.paper.row("paper, sparse, mean"), 1.0 / 25));
  state(book, what + ", full rate", "1.2 x PI mutex + memcpy", full,
        times(all.row("PI mutex + memcpy, full rate"), 1.2));
  state(book, what + ", full rate", "1.2 x triple buffer", full,
        times(all.row("triple buffer, full rate"), 1.2));
  state(book, what + ", sparse, median", "below PI mutex + memcpy",
        all.row("**mauve**, sparse, median"), all.row("PI mutex + memcpy, sparse, median"));
  if (mauve::rt::usable_cpus().size() > 1) {
    const auto& contended = all.row("**mauve**, contended");
    state(book, what + ", contended", "1.2 x triple buffer", contended,
          times(all.row("triple buffer, contended"), 1.2));
    state(book, what + ", contended", "1.2 x PI mutex + memcpy", contended,
          times(all.row("PI mutex + memcpy, contended"), 1.2));
  }
  state(book, what + ", full rate", "below Orocos LOCK_FREE, measured once elsewhere", full,
        side.paper.row("Orocos 2.9 LOCK_FREE, full rate, measured once"));
  state(book, what + ", full rate", "below iceoryx, measured once elsewhere", full,
        side.paper.row("iceoryx 2.0, full rate, measured once"));
}

}  // namespace

void measure_exchange(Book& book, const Setting& setting) {
  std::array<Side, 2> sides;
  put_paper(sides);
  measure_size<0>(setting, sides);
  measure_size<1>(setting, sides);
  measure_size<2>(setting, sides);
  measure_size<3>(setting, sides);
  measure_size<4>(setting, sides);
  measure_size<5>(setting, sides);
  book.text(
      "Tables 5 and 6: one write or read through a connected port. Sparse: each way once in 10 ms, "
      "all of them in the same seconds on CPU " +
      std::to_string(setting.cpu) +
      ", two readings of the clock included (20 ns each). Full rate, contended: medians of "
      "batches; contended is a writer and a reader on two CPUs that do nothing else.");
  print(book, "Table 5: write", "table5", sides[0]);
  print(book, "Table 6: read", "table6", sides[1]);
  state_goals(book, "Table 5, write", sides[0]);
  state_goals(book, "Table 6, read", sides[1]);
}

}  // namespace bench::paper
