// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tables 5 and 6: SharedData through ports against code written by hand.
///   `sparse`     as in the paper: write, 10 ms, read, 10 ms; the caches hold none of it any more.
///   `full rate`  again and again, alone.
///   `contended`  a writer and a reader at full rate on two CPUs.
#include "bench/support/exchange.h"

#include <array>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/paper/experiments.h"
#include "bench/paper/tasks.h"

#include <mauve/host/deployer.h>

namespace bench::paper {
namespace {

constexpr std::array<std::size_t, 6> kSizes{1, 10, 100, 1000, 10'000, 100'000};
constexpr int kPriority = 50;
constexpr Duration kBetween{10ms};

/// For each size, ns.
using Values = std::array<double, kSizes.size()>;

/// Rows by name, with what was measured in them.
class Table {
 public:
  void add(const std::string& name, std::size_t column, double value) {
    row(name)[column].push_back(value);
  }
  void put(const std::string& name, const Values& values) {
    for (std::size_t i = 0; i < values.size(); ++i) add(name, i, values[i]);
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& [name, samples] : rows_) names.push_back(name);
    return names;
  }
  /// Medians; 0 where nothing was measured.
  [[nodiscard]] Values values(const std::string& name) {
    Values values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!row(name)[i].empty()) values[i] = median(row(name)[i]);
    }
    return values;
  }

 private:
  using Samples = std::array<std::vector<double>, kSizes.size()>;
  Samples& row(const std::string& name) {
    for (auto& [known, samples] : rows_) {
      if (known == name) return samples;
    }
    return rows_.emplace_back(name, Samples{}).second;
  }
  std::vector<std::pair<std::string, Samples>> rows_;
};

/// Table 5 or 6.
struct Side {
  Table paper;
  Table measured;
};

/// The times of one way that is used seldom, ns.
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
    table.add(name + ", sparse, min", column, of.least);
    table.add(name + ", sparse, median", column, of.middle);
    table.add(name + ", sparse, mean", column, of.mean);
    table.add(name + ", sparse, max", column, of.most);
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
void measure_alone(Contenders<Size>& ways, const Setting& setting, std::size_t column,
                   std::array<Side, 2>& sides) {
  const std::vector<Operation> operations{
      ways.write(),        ways.read(),        ways.locked_write(), ways.locked_read(),
      ways.triple_write(), ways.triple_read(), ways.copy(),         ways.copy()};
  const int times = Size < 5000 ? 1000 : 50;
  const auto results = alone(operations, times, setting.options.choose(100, 5));
  constexpr std::array names{"**mauve**", "PI mutex + memcpy", "triple buffer", "memcpy"};
  for (std::size_t i = 0; i < results.size(); ++i) {
    sides[i % 2].measured.add(std::string(names[i / 2]) + ", full rate", column, results[i]);
  }
}

template <std::size_t Size>
void measure_together(Contenders<Size>& ways, const Setting& setting, std::size_t column,
                      std::array<Side, 2>& sides) {
  if (mauve::rt::usable_cpus().size() < 2) return;
  const int times = Size < 5000 ? 50 : 5;
  constexpr std::array names{"**mauve**", "PI mutex + memcpy", "triple buffer"};
  for (int turn = 0; turn < setting.options.choose(3, 1); ++turn) {
    const std::array measured{together(ways.write(), ways.read(), times),
                              together(ways.locked_write(), ways.locked_read(), times),
                              together(ways.triple_write(), ways.triple_read(), times)};
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const std::string name = std::string(names[i]) + ", contended";
      for (std::size_t side = 0; side < 2; ++side) {
        sides[side].measured.add(name, column, measured[i][side]);
      }
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
  sides[0].measured.add("roscpp, sparse, publish(), median", column, median(published));
  sides[1].measured.add("roscpp, sparse, publish() to callback, median", column, median(arrived));
}

/// Used objects stay allocated, so that each round lies elsewhere in memory.
using Used = std::vector<std::shared_ptr<void>>;

/// All sizes at full rate. One round takes a second: what the host does meanwhile spoils one.
template <std::size_t... Column>
void measure_round(const Setting& setting, std::array<Side, 2>& sides, Used& used,
                   std::index_sequence<Column...> /*all*/) {
  const auto measure = [&]<std::size_t Size>(std::size_t column) {
    const auto ways = std::make_shared<Contenders<Size>>();
    used.push_back(ways);
    measure_alone(*ways, setting, column, sides);
    measure_together(*ways, setting, column, sides);
  };
  (measure.template operator()<kSizes[Column]>(Column), ...);
}

/// All of it: a round at full rate before each size that is used seldom.
template <std::size_t... Column>
void measure_sizes(const Setting& setting, std::array<Side, 2>& sides,
                   std::index_sequence<Column...> all) {
  Used used;
  const auto measure = [&]<std::size_t Size>(std::size_t column) {
    measure_round(setting, sides, used, all);
    measure_sparse<Size>(setting, column, sides);
    measure_ros(setting, column, sides);
  };
  (measure.template operator()<kSizes[Column]>(Column), ...);
}

void put_paper(std::array<Side, 2>& sides) {
  Table& write = sides[0].paper;
  write.put("paper, sparse, min", {2088, 1991, 2078, 2670, 7365, 77571});
  write.put("paper, sparse, mean", {4239, 4034, 4319, 4804, 12874, 120836});
  write.put("paper, sparse, max", {7856, 8983, 10601, 11947, 35358, 151525});
  Table& read = sides[1].paper;
  read.put("paper, sparse, min", {2042, 1955, 2167, 2182, 4705, 38280});
  read.put("paper, sparse, mean", {4037, 3997, 4198, 4367, 9174, 64544});
  read.put("paper, sparse, max", {11005, 11475, 10961, 10939, 18087, 105324});
  // Medians of one session with the programs of each project, on two virtual CPUs like these.
  write.put("Orocos 2.9 LOCK_FREE, full rate, measured once", {111, 0, 123, 132, 246, 1750});
  write.put("iceoryx 2.0, full rate, measured once", {583, 0, 571, 610, 707, 1850});
  read.put("Orocos 2.9 LOCK_FREE, full rate, measured once", {68, 0, 75, 80, 137, 867});
  read.put("iceoryx 2.0, full rate, measured once", {162, 0, 168, 179, 248, 910});
}

void print(Book& book, const std::string& title, const std::string& name, Side& side) {
  const Row head{"ns", "1 B", "10 B", "100 B", "1 kB", "10 kB", "100 kB"};
  std::vector<Row> rows;
  for (Table* table : {&side.paper, &side.measured}) {
    for (const std::string& label : table->names()) {
      Row row{label};
      for (const double value : table->values(label)) row.push_back(value == 0 ? "" : ns(value));
      rows.push_back(row);
    }
  }
  book.table(title, head, rows);
  book.csv(name, head, rows);
}

Values times(Values values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

/// The size at which ours is worst compared with a limit for each size; 0: no limit there. `floor`:
/// what a bare memcpy takes here, reported where that is over the limit.
void state(Book& book, const std::string& what, const std::string& target, const Values& ours,
           const Values& limit, const Values& floor = {}) {
  std::size_t worst = 0;
  double most = 0;
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    if (limit[i] == 0 || ours[i] == 0 || ours[i] / limit[i] <= most) continue;
    most = ours[i] / limit[i];
    worst = i;
  }
  if (most == 0) return;
  std::string measured = "worst at " + std::to_string(kSizes[worst]) + " B: " + ns(ours[worst]) +
                         " ns of " + ns(limit[worst]) + " ns";
  if (floor[worst] > limit[worst]) measured += " (memcpy alone: " + ns(floor[worst]) + " ns)";
  book.goal(what, target, measured, most <= 1);
}

void state_goals(Book& book, const std::string& what, Side& side) {
  Table& all = side.measured;
  const Values full = all.values("**mauve**, full rate");
  const Values copied = all.values("memcpy, full rate");
  state(book, what + ", full rate", "paper / 25", full,
        times(side.paper.values("paper, sparse, mean"), 1.0 / 25), copied);
  state(book, what + ", full rate", "1.2 x PI mutex + memcpy", full,
        times(all.values("PI mutex + memcpy, full rate"), 1.2));
  state(book, what + ", full rate", "1.2 x triple buffer", full,
        times(all.values("triple buffer, full rate"), 1.2));
  state(book, what + ", sparse, median", "below PI mutex + memcpy",
        all.values("**mauve**, sparse, median"), all.values("PI mutex + memcpy, sparse, median"));
  if (mauve::rt::usable_cpus().size() > 1) {
    const Values contended = all.values("**mauve**, contended");
    state(book, what + ", contended", "1.2 x triple buffer", contended,
          times(all.values("triple buffer, contended"), 1.2));
    state(book, what + ", contended", "1.2 x PI mutex + memcpy", contended,
          times(all.values("PI mutex + memcpy, contended"), 1.2));
  }
  state(book, what + ", full rate", "below Orocos LOCK_FREE, measured once elsewhere", full,
        side.paper.values("Orocos 2.9 LOCK_FREE, full rate, measured once"), copied);
  state(book, what + ", full rate", "below iceoryx, measured once elsewhere", full,
        side.paper.values("iceoryx 2.0, full rate, measured once"), copied);
}

/// Two CPUs share one line: who of the two asks more often has it at the cost of the other one.
void state_both(Book& book, std::array<Side, 2>& sides) {
  if (mauve::rt::usable_cpus().size() < 2) return;
  const auto both = [&sides](const std::string& row) {
    Values sum = sides[0].measured.values(row);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += sides[1].measured.values(row)[i];
    return sum;
  };
  state(book, "Tables 5 and 6, write and read, contended", "1.2 x triple buffer",
        both("**mauve**, contended"), times(both("triple buffer, contended"), 1.2));
}

}  // namespace

void measure_exchange(Book& book, const Setting& setting) {
  std::array<Side, 2> sides;
  put_paper(sides);
  measure_sizes(setting, sides, std::make_index_sequence<kSizes.size()>());
  book.text(
      "Tables 5 and 6: one write or read through a connected port. Sparse: each way once in 10 ms, "
      "all of them in the same seconds on CPU " +
      std::to_string(setting.cpu) +
      ", two readings of the clock included (20 ns each). Full rate, contended: medians of batches "
      "in six rounds, seconds and memory apart; contended is a writer and a reader on two CPUs "
      "that do nothing else.");
  print(book, "Table 5: write", "table5", sides[0]);
  print(book, "Table 6: read", "table6", sides[1]);
  state_goals(book, "Table 5, write", sides[0]);
  state_goals(book, "Table 6, read", sides[1]);
  state_both(book, sides);
}

}  // namespace bench::paper
