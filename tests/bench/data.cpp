// SPDX-License-Identifier: LGPL-3.0-or-later
/// Writing and reading SharedData through connected ports, as a job does, against a plain copy, a
/// copy under a priority-inheritance mutex, and a raw triple buffer.
#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "bench/support/exchange.h"
#include "bench/support/report.h"

namespace bench {
namespace {

std::string text_of(std::size_t size) {
  return size < 1000 ? std::to_string(size) + " B" : std::to_string(size / 1000) + " kB";
}

template <std::size_t Size>
void measure_alone(Report& report, const Options& options) {
  const std::string text = text_of(Size);
  const Target target = Size <= 100 ? at_most(40) : Size == 100'000 ? times_raw(1.1) : Target{};
  std::array<Figure*, 6> figures{
      &report.figure("write " + text + ", against memcpy", "ns", target),
      &report.figure("write " + text + ", against a PI mutex", "ns"),
      &report.figure("write " + text + ", against a triple buffer", "ns"),
      &report.figure("read " + text + ", against memcpy", "ns", target),
      &report.figure("read " + text + ", against a PI mutex", "ns"),
      &report.figure("read " + text + ", against a triple buffer", "ns")};
  const int times = Size < 5000 ? 1000 : 50;
  for (int i = 0; i < options.rounds; ++i) {
    const auto placed = std::make_unique<Placed<Contenders<Size>>>(i);
    auto& ways = placed->value();
    const std::vector<Operation> operations{
        ways.copy(),        ways.write(),        ways.read(),       ways.locked_write(),
        ways.locked_read(), ways.triple_write(), ways.triple_read()};
    const auto ns = alone(operations, times, options.choose(50, 5));
    figures[0]->add(ns[1], ns[0]);
    figures[1]->add(ns[1], ns[3]);
    figures[2]->add(ns[1], ns[5]);
    figures[3]->add(ns[2], ns[0]);
    figures[4]->add(ns[2], ns[4]);
    figures[5]->add(ns[2], ns[6]);
  }
}

template <std::size_t Size>
void measure_together(Report& report, const Options& options) {
  const std::string text = text_of(Size) + " while the other CPU ";
  std::array<Figure*, 4> figures{
      &report.figure("write " + text + "reads, against a PI mutex", "ns"),
      &report.figure("write " + text + "reads, against a triple buffer", "ns"),
      &report.figure("read " + text + "writes, against a PI mutex", "ns"),
      &report.figure("read " + text + "writes, against a triple buffer", "ns")};
  const auto ways = std::make_unique<Contenders<Size>>();
  const int times = Size < 5000 ? 50 : 5;
  for (int i = 0; i < options.rounds; ++i) {
    const auto ours = together(ways->write(), ways->read(), times);
    const auto locked = together(ways->locked_write(), ways->locked_read(), times);
    const auto triple = together(ways->triple_write(), ways->triple_read(), times);
    figures[0]->add(ours[0], locked[0]);
    figures[1]->add(ours[0], triple[0]);
    figures[2]->add(ours[1], locked[1]);
    figures[3]->add(ours[1], triple[1]);
  }
}

void run(const Options& options) {
  Report report("data",
                "SharedData through connected ports inside a job: ns for one write or read, alone "
                "on a CPU and then with a reader and a writer at once on two.",
                options);
  measure_alone<1>(report, options);
  measure_alone<100>(report, options);
  measure_alone<1000>(report, options);
  measure_alone<10'000>(report, options);
  measure_alone<100'000>(report, options);
  if (mauve::rt::usable_cpus().size() < 2) {
    report.note("Not measured on two CPUs at once: this process may use only one.");
  } else {
    measure_together<100>(report, options);
    measure_together<100'000>(report, options);
  }
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
