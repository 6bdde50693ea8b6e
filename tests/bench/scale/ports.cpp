// SPDX-License-Identifier: LGPL-3.0-or-later
/// A job that reads and writes 1 to 100 pairs of ports, each pair on shared data of its own.
#include <deque>
#include <string>
#include <thread>

#include "bench/scale/sweeps.h"
#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/sweep.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace bench::scale {
namespace {

constexpr Duration kJobEvery{1'000'000};

/// So many ports of each kind has the next shell: its component makes it without arguments.
int width = 1;

struct Wide : mauve::Shell {
  Wide() {
    for (int i = 0; i < width; ++i) {
      in.emplace_back(*this, names.emplace_back("in" + std::to_string(i)));
      out.emplace_back(*this, names.emplace_back("out" + std::to_string(i)));
    }
  }
  std::deque<std::string> names;  // a port does not copy its name
  std::deque<mauve::ReadPort<double>> in;
  std::deque<mauve::WritePort<double>> out;
};

struct Passing : mauve::Core<Wide> {
  mauve::Stateless stateless{*this};
  void update() {
    for (std::size_t i = 0; i < shell().in.size(); ++i) {
      shell().out[i].write(shell().in[i].read() + 1);
    }
  }
};

struct Ports : mauve::Architecture {
  explicit Ports(int cpu) {
    for (int i = 0; i < width; ++i) data.emplace_back(*this, "data" + std::to_string(i), 0.0);
    component.fsm().period = kJobEvery;
    component.task().priority = 80;
    component.task().cpus = {cpu};
  }
  mauve::Status on_configure() override {
    for (std::size_t i = 0; i < data.size(); ++i) {
      mauve::Status done = component.shell().in[i].connect(data[i].read_service());
      if (done) done = component.shell().out[i].connect(data[i].write_service());
      if (!done) return done;
    }
    return mauve::ok();
  }
  std::deque<mauve::SharedData<double>> data;
  mauve::Component<Wide, Passing, mauve::PeriodicFsm<Passing>> component{*this, "passing"};
};

/// The times of its jobs, from the runtime's own statistics.
mauve::Distribution measure(int count, Duration time) {
  width = count;
  Ports architecture(mauve::rt::usable_cpus().back());
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  std::this_thread::sleep_for(time);
  const auto found = deployer.statistics("passing").execution;
  static_cast<void>(deployer.shutdown());
  return found;
}

}  // namespace

void sweep_ports(Book& book, const Options& options) {
  const Duration time = std::chrono::milliseconds(options.choose(2000, 200));
  Sweep sweep("ports", "Ports, half of them read and half written in each job at 1 kHz", "ports",
              {{"job, mean, ns", "ns a port"}, {"p50, ns", "ns a port"}, {"p99, ns", "ns a port"}});
  for (int round = 0; round < options.rounds; ++round) {
    for (const int count : {1, 10, 50, 100}) {
      const mauve::Distribution job = measure(count, time);
      sweep.add(2 * count, {static_cast<double>(job.mean().count()),
                            static_cast<double>(job.percentile(50).count()),
                            static_cast<double>(job.percentile(99).count())});
    }
  }
  sweep.print(book);
  book.text(
      "A double each. By the runtime's own statistics, jobs that nothing came between: the CPU "
      "slept before each of them, so caches are as cold as they are in a robot.");
}

}  // namespace bench::scale
