// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/peers/measure.h"

#include <memory>
#include <thread>

#include "bench/support/checked.h"
#include "bench/support/exchange.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace bench::peers {
namespace {

constexpr std::size_t kWarmUp = 20;

std::vector<double> times_of(const Calls& calls) {
  std::vector<double> times;
  for (std::size_t i = kWarmUp; i < calls.begins.size(); ++i) {
    times.push_back(static_cast<double>(calls.ends[i] - calls.begins[i]));
  }
  return times;
}

template <typename T>
struct Writing : mauve::Core<WriterShell<T>> {
  mauve::Stateless stateless{*this};
  Exchange* exchange = nullptr;
  void update() {
    exchange->write(
        [this](const void* data) { this->shell().out.write(*static_cast<const T*>(data)); });
  }
};
template <typename T>
struct Reading : mauve::Core<ReaderShell<T>> {
  mauve::Stateless stateless{*this};
  Exchange* exchange = nullptr;
  void update() {
    exchange->read([this](void* into) { this->shell().in.read(*static_cast<T*>(into)); });
  }
};

template <typename T>
struct Pair : mauve::Architecture {
  Pair(Exchange& exchange, int cpu) {
    writer.fsm().period = kPeriod;
    reader.fsm().period = kPeriod;
    writer.task().priority = reader.task().priority = kPriority;
    writer.task().cpus = reader.task().cpus = {cpu};
    reader.task().offset = kPeriod / 2;
    writer.core().exchange = &exchange;
    reader.core().exchange = &exchange;
  }
  mauve::SharedData<T> data{*this, "data", T{}};
  mauve::Component<WriterShell<T>, Writing<T>, mauve::PeriodicFsm<Writing<T>>> writer{*this,
                                                                                      "writer"};
  mauve::Component<ReaderShell<T>, Reading<T>, mauve::PeriodicFsm<Reading<T>>> reader{*this,
                                                                                      "reader"};
  mauve::Status on_configure() override {
    if (auto done = reader.shell().in.connect(data.read_service()); !done) return done;
    return writer.shell().out.connect(data.write_service());
  }
};

template <std::size_t Size>
Round measure_pair(int cpu, Duration time) {
  Exchange exchange(Size);
  const auto pair = std::make_unique<Pair<Block<Size>>>(exchange, cpu);
  mauve::Deployer deployer(*pair);
  must(deployer.deploy());
  const Instant first = deployer.t0();
  std::this_thread::sleep_for(time);
  static_cast<void>(deployer.shutdown());
  return result_of(exchange, first);
}

}  // namespace

Round result_of(const Exchange& exchange, Instant first) {
  Round round;
  round.writes = times_of(exchange.writes());
  round.reads = times_of(exchange.reads());
  const Calls& writes = exchange.writes();
  for (std::size_t i = kWarmUp; i < writes.begins.size(); ++i) {
    const Instant late = (writes.begins[i] - first) % kPeriod.count();
    const Instant release = writes.begins[i] - late;
    round.steps.push_back(static_cast<double>(writes.ends[i] - release) / 1e3);
  }
  round.read_jobs = exchange.reads().begins.size();
  round.arrived = exchange.arrived();
  return round;
}

Round measure_peer(Peer& peer, std::size_t size, int cpu, Duration time) {
  Exchange exchange(size);
  const int priority = fifo_or_none(kPriority);
  const Instant first = now() + 10 * kPeriod.count();
  {
    const RawLoop writer(cpu, priority, first, kPeriod, [&](Instant) {
      exchange.write([&peer](const void* data) { peer.write(data); });
    });
    const RawLoop reader(cpu, priority, first + kPeriod.count() / 2, kPeriod,
                         [&](Instant) { exchange.read([&peer](void* into) { peer.read(into); }); });
    std::this_thread::sleep_for(time);
  }
  return result_of(exchange, first);
}

Round measure_mauve(std::size_t size, int cpu, Duration time) {
  static_assert(kSizes.size() == 4);
  if (size == kSizes[0]) return measure_pair<kSizes[0]>(cpu, time);
  if (size == kSizes[1]) return measure_pair<kSizes[1]>(cpu, time);
  if (size == kSizes[2]) return measure_pair<kSizes[2]>(cpu, time);
  return measure_pair<kSizes[3]>(cpu, time);
}

}  // namespace bench::peers
