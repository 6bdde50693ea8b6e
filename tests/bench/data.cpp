// SPDX-License-Identifier: LGPL-3.0-or-later
/// Writing and reading SharedData through connected ports, as a job does, against a plain copy, a
/// copy under a priority-inheritance mutex, and a raw triple buffer.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <string>

#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"
#include "bench/support/report.h"

#include <mauve/architecture.h>
#include <mauve/job.h>

namespace bench {
namespace {

constexpr int kPriority = 50;

template <std::size_t Size>
struct Block {
  std::array<std::byte, Size> bytes{};
};

template <typename T>
struct Ports : mauve::Shell {
  mauve::ReadPort<T> in{*this, "in"};
  mauve::WritePort<T> out{*this, "out"};
};
template <typename T>
struct Idle : mauve::Core<Ports<T>> {
  mauve::Stateless stateless{*this};
  void update() {}
};
template <typename T>
struct Wired : mauve::Architecture {
  mauve::SharedData<T> data{*this, "data", T{}};
  mauve::Component<Ports<T>, Idle<T>, mauve::PeriodicFsm<Idle<T>>> component{*this, "component"};
  mauve::Status on_configure() override {
    if (auto done = component.shell().in.connect(data.read_service()); !done) return done;
    return component.shell().out.connect(data.write_service());
  }
};

/// Keeps the compiler from leaving copies out.
inline void touch(void* data) { asm volatile("" : : "r"(data) : "memory"); }

/// A job of this thread, so that values are stamped as in one.
class InJob {
 public:
  InJob() { mauve::this_job().start = now(); }
  ~InJob() { mauve::this_job().start = 0; }
};

using Operation = std::function<void(int times)>;

/// The ways to move a value of one size; each operation does it many times.
template <std::size_t Size>
struct Contenders {
  using T = Block<Size>;

  Contenders() { must(wired.configure()); }
  template <typename Body>
  Operation repeat(Body body) {
    return [body](int times) {
      const InJob job;
      for (int i = 0; i < times; ++i) body();
    };
  }
  Operation write() {
    return repeat([&] { touch(&from), wired.component.shell().out.write(from); });
  }
  Operation read() {
    return repeat([&] { wired.component.shell().in.read(into), touch(&into); });
  }
  Operation copy() {
    return repeat([&] {
      touch(&from);
      std::memcpy(&other, &from, size);
      touch(&other);
    });
  }
  Operation locked_write() {
    return repeat([&] { touch(&from), locked.write(&from); });
  }
  Operation locked_read() {
    return repeat([&] { locked.read(&into), touch(&into); });
  }
  Operation triple_write() {
    return repeat([&] { touch(&from), triple.write(&from); });
  }
  Operation triple_read() {
    return repeat([&] { triple.read(&into), touch(&into); });
  }

  volatile std::size_t size = Size;  // as the runtime, the copy does not know it
  Wired<T> wired;
  RawPiMutex locked{Size};
  RawTripleBuffer triple{Size};
  T from{};
  T into{};
  T other{};
};

/// Nanoseconds for each operation alone on a CPU: medians of batches in turn.
std::vector<double> alone(const std::vector<Operation>& operations, int times, int batches) {
  std::vector<std::vector<double>> results(operations.size());
  const int priority = fifo_or_none(kPriority);
  for (int batch = 0; batch < batches; ++batch) {
    const OnCpu here(mauve::rt::usable_cpus().back(), priority);
    for (std::size_t i = 0; i < operations.size(); ++i) {
      const Instant start = now();
      operations[i](times);
      results[i].push_back(static_cast<double>(now() - start) / times);
    }
  }
  std::vector<double> medians;
  for (auto& result : results) medians.push_back(median(result));
  return medians;
}

/// Nanoseconds for each of two operations that run at the same time on two CPUs.
std::array<double, 2> together(const Operation& first, const Operation& second, int times) {
  const std::array<const Operation*, 2> operations{&first, &second};
  const std::vector<int> cpus = mauve::rt::usable_cpus();
  const int priority = fifo_or_none(kPriority);
  std::atomic<int> ready{0};
  std::atomic<bool> over{false};
  std::array<double, 2> results{};
  std::array<mauve::rt::Thread, 2> threads;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto body = [&, i] {
      for (ready.fetch_add(1); ready.load() < 2;) {
      }
      const Instant start = now();
      int done = 0;
      for (; !over.load(std::memory_order_relaxed) && done < 1000 * times; done += times) {
        (*operations[i])(times);
        if (now() - start > 10'000'000) over.store(true, std::memory_order_relaxed);
      }
      results[i] = static_cast<double>(now() - start) / done;
    };
    static_cast<void>(threads[i].start({"bench-data", priority, {cpus[i]}}, body));
  }
  for (auto& thread : threads) thread.join();
  return results;
}

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
  const auto ways = std::make_unique<Contenders<Size>>();
  const std::vector<Operation> operations{
      ways->copy(),        ways->write(),        ways->read(),       ways->locked_write(),
      ways->locked_read(), ways->triple_write(), ways->triple_read()};
  const int times = Size < 5000 ? 1000 : 50;
  for (int i = 0; i < options.rounds; ++i) {
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
  const int times = Size < 5000 ? 500 : 20;
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
