// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tables 2 and 3: the two tasks beside the disturbing process, in turn by each platform.
#include <cmath>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "bench/paper/experiments.h"
#include "bench/paper/tasks.h"

namespace bench::paper {
namespace {

/// Wide enough that the probe itself costs the tasks nothing worth mentioning.
constexpr Duration kProbePeriod{2ms};

/// Of one task, ms.
struct Samples {
  std::vector<double> execution;
  std::vector<double> period;
  std::vector<double> from_launch;
  std::vector<double> from_reference;
  std::vector<double> from_t0;
  std::vector<double> response;  // of the first execution, from the reference or the launch
  std::size_t apart = 0;
};

struct Platform {
  std::string name;
  std::function<Run()> run;
  Samples a;
  Samples b;
  int runs = 0;
  int b_first = 0;
  int apart = 0;  // runs whose beginning was disturbed
};

double between(Instant from, Instant to) { return static_cast<double>(to - from) / 1e6; }

void add_cycles(const std::vector<Cycle>& cycles, int cpu, const Probe& probe, Samples& into) {
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (probe.disturbed(cpu, cycles[i].start, cycles[i].end)) {
      ++into.apart;
      continue;
    }
    into.execution.push_back(between(cycles[i].start, cycles[i].end));
    if (i == 0 || probe.disturbed(cpu, cycles[i - 1].start, cycles[i].start)) continue;
    into.period.push_back(between(cycles[i - 1].start, cycles[i].start));
  }
}

void add_first(const Cycle& first, const Run& run, Instant launched, Samples& into) {
  const Instant from = run.reference != 0 ? run.reference : launched;
  into.from_launch.push_back(between(launched, first.start));
  into.response.push_back(between(from, first.end));
  if (run.reference == 0) return;
  into.from_reference.push_back(between(run.reference, first.start));
  into.from_t0.push_back(between(run.t0, first.start));
}

void add(const Run& run, int cpu, const Probe& probe, Platform& platform) {
  if (run.a.empty() || run.b.empty()) return;
  ++platform.runs;
  add_cycles(run.a, cpu, probe, platform.a);
  add_cycles(run.b, cpu, probe, platform.b);
  platform.b_first += run.b[0].start < run.a[0].start ? 1 : 0;
  if (probe.disturbed(cpu, run.launched_a, run.a[0].end)) {
    ++platform.apart;
    return;
  }
  add_first(run.a[0], run, run.launched_a, platform.a);
  add_first(run.b[0], run, run.launched_b, platform.b);
}

void add_all(Row& row, const std::vector<double>& samples) {
  const Statistics of = statistics(samples);
  row.push_back(of.count == 0 ? "" : ms(of.mean));
  row.push_back(of.count == 0 ? "" : ms(of.deviation));
}

const std::vector<Row>& paper_table_2() {
  static const std::vector<Row> rows{
      {"paper: ROS", "35.358", "2.561", "19.912", "1.813", "100.002", "0.628", "100.002", "0.658"},
      {"paper: OROCOS-bg", "31.936", "1.447", "12.028", "1.301", "99.998", "0.831", "100.0",
       "0.057"},
      {"paper: OROCOS-prio", "30.097", "2.076", "12.015", "1.276", "99.992", "2.299", "100.0",
       "0.214"},
      {"paper: OROCOS-isolated", "31.573", "1.598", "12.021", "1.194", "99.991", "1.521", "100.0",
       "0.244"},
      {"paper: MAUVE", "20.059", "0.725", "11.975", "1.254", "99.997", "1.589", "100.0", "0.216"}};
  return rows;
}

const std::vector<Row>& paper_table_3() {
  static const std::vector<Row> rows{
      {"paper: ROS", "7.024", "1.280", "50.272", "5.196", "37.826", "3.040", "70.141", "6.641"},
      {"paper: OROCOS-bg", "101.332", "4.504", "100.002", "0.013", "134.281", "0.909", "114.324",
       "0.901"},
      {"paper: OROCOS-prio", "104.143", "6.603", "100.007", "0.011", "135.018", "2.306", "114.200",
       "1.120"},
      {"paper: OROCOS-isolated", "105.486", "6.920", "100.033", "0.036", "134.154", "1.500",
       "113.751", "1.278"},
      {"paper: MAUVE", "14.288", "1.086", "0.110", "0.030", "36.242", "2.373", "14.232", "1.080"}};
  return rows;
}

void print_table_2(Book& book, const std::vector<Platform>& platforms) {
  const Row head{"ms", "A executes", "sd", "B executes", "sd", "A period", "sd", "B period", "sd"};
  std::vector<Row> rows = paper_table_2();
  std::vector<Row> samples;
  for (const Platform& one : platforms) {
    if (one.runs == 0) continue;
    Row row{"**" + one.name + "**"};
    for (const auto* of : {&one.a.execution, &one.b.execution, &one.a.period, &one.b.period}) {
      add_all(row, *of);
    }
    rows.push_back(row);
    for (const double value : one.a.execution) samples.push_back({one.name, "a", ms(value)});
    for (const double value : one.b.execution) samples.push_back({one.name, "b", ms(value)});
  }
  book.table("Table 2: executions and periods", head, rows);
  book.csv("table2", head, rows);
  book.csv("executions", {"platform", "task", "ms"}, samples);
}

void print_table_3(Book& book, const std::vector<Platform>& platforms) {
  const Row head{"ms", "A begins", "sd", "B begins", "sd", "A responds", "sd", "B responds", "sd"};
  std::vector<Row> rows = paper_table_3();
  for (const Platform& one : platforms) {
    if (one.a.response.empty()) continue;
    const bool common = !one.a.from_reference.empty();
    Row row{"**" + one.name + (common ? "**, from the reference of the clock" : "**")};
    for (const Samples* of : {&one.a, &one.b}) {
      add_all(row, common ? of->from_reference : of->from_launch);
    }
    for (const Samples* of : {&one.a, &one.b}) add_all(row, of->response);
    rows.push_back(row);
    if (!common) continue;
    row = {one.name + ", from T0"};
    for (const Samples* of : {&one.a, &one.b}) add_all(row, of->from_t0);
    row.insert(row.end(), 4, "");
    rows.push_back(row);
  }
  book.table("Table 3: first execution after the launch", head, rows);
  book.csv("table3", head, rows);
  std::string order = "B ran before A at the first release:";
  for (const Platform& one : platforms) {
    if (one.runs == 0) continue;
    order += " " + one.name + " " + std::to_string(one.b_first) + " of " +
             std::to_string(one.runs) + " runs (" + std::to_string(one.apart) +
             " of them disturbed at the beginning and left out above; so were " +
             std::to_string(one.a.apart + one.b.apart) + " cycles of Table 2).";
  }
  book.text(order);
}

double mean(const std::vector<double>& samples) { return statistics(samples).mean; }

void state_noise(Book& book, const std::string& what, const std::vector<double>& ours,
                 const std::vector<double>& raw) {
  const Statistics floor = statistics(raw);
  const double apart = std::abs(mean(ours) - floor.mean);
  book.goal(what + ", mean", "raw " + ms(floor.mean) + " +- its sd " + ms(floor.deviation) + " ms",
            ms(mean(ours)) + " ms", apart <= floor.deviation);
}

void state_goals(Book& book, const Platform& mauve, const Platform& raw) {
  state_noise(book, "Table 2, execution of A", mauve.a.execution, raw.a.execution);
  state_noise(book, "Table 2, execution of B", mauve.b.execution, raw.b.execution);
  state_noise(book, "Table 2, period of A", mauve.a.period, raw.a.period);
  state_noise(book, "Table 2, period of B", mauve.b.period, raw.b.period);
  const auto offset = [&](const std::string& what, const std::vector<double>& ours,
                          const std::vector<double>& floor) {
    const double limit = statistics(floor).middle + 0.010;
    const double middle = statistics(ours).middle;
    book.goal("Table 3, " + what + ", median", "raw + 10 us = " + ms(limit) + " ms",
              ms(middle) + " ms", middle <= limit);
  };
  offset("A begins, from the reference", mauve.a.from_reference, raw.a.from_reference);
  offset("B begins, from the reference", mauve.b.from_reference, raw.b.from_reference);
  offset("A begins, from T0", mauve.a.from_t0, raw.a.from_t0);
  offset("B begins, from T0", mauve.b.from_t0, raw.b.from_t0);
  book.goal("Table 3, B before A", "always",
            std::to_string(mauve.b_first) + " of " + std::to_string(mauve.runs) + " runs",
            mauve.b_first == mauve.runs);
}

}  // namespace

void measure_execution(Book& book, const Setting& setting) {
  const Duration time = setting.options.choose(2000, 300) * 1ms;
  const int cpu = setting.cpu;
  std::vector<Platform> platforms;
  platforms.push_back({"mauve", [=] { return run_mauve(cpu, time); }, {}, {}});
  platforms.push_back({"raw POSIX", [=] { return run_raw(cpu, time); }, {}, {}});
  if (!setting.ros.empty()) {
    const auto ros = [=] { return run_processes(setting.ros, cpu, time); };
    platforms.push_back({"roscpp", ros, {}, {}});
  }
  if (!setting.orocos.empty()) {
    for (const char* variant : {"bg", "prio", "isolated"}) {
      const auto orocos = [=] { return run_process(setting.orocos, variant, cpu, time); };
      platforms.push_back({std::string("OROCOS-") + variant, orocos, {}, {}});
    }
  }
  const int rounds = setting.options.choose(30, 1);
  const Disturber disturber(cpu);
  for (int round = 0; round < rounds; ++round) {
    for (Platform& platform : platforms) {
      const Probe probe(now(), kProbePeriod);
      std::this_thread::sleep_for(10 * kProbePeriod);  // it costs each of them the same
      const Run run = platform.run();
      add(run, cpu, probe, platform);
    }
  }
  book.text("Tables 2 and 3: " + std::to_string(rounds) + " runs of " + std::to_string(time / 1ms) +
            " ms of each, in turn, on CPU " + std::to_string(cpu) +
            " beside the disturbing process. A computes for 20 ms with priority 20, B for 10 ms "
            "with priority 50, each 100 ms, by the clock of the thread. The reference of the clock "
            "is 210 us before T0, for raw as for mauve.");
  print_table_2(book, platforms);
  print_table_3(book, platforms);
  state_goals(book, platforms[0], platforms[1]);
}

}  // namespace bench::paper
