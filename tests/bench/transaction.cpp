// SPDX-License-Identifier: LGPL-3.0-or-later
/// The cost of a transaction over 100 running components: the time of the coordinator until the
/// decision, and of each member. The whole lasts from the request until the last member is in
/// force. The comparison is a raw coordinator that fills 100 mailboxes and changes one word.
#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "bench/support/checked.h"
#include "bench/support/counting.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"
#include "bench/support/report.h"
#include "exec/commit/commit.h"
#include "exec/commit/under_way.h"
#include "exec/deploy/bring_up.h"
#include "exec/deploy/shutdown.h"
#include "exec/prepare/prepare.h"
#include "exec/run/threads.h"
#include "exec/system/events.h"
#include "exec/system/system.h"

#include <mauve/host/architecture.h>
#include <mauve/host/receipt.h>

namespace bench {
namespace {

namespace exec = mauve::exec;

constexpr std::size_t kMembers = 100;
constexpr Duration kPeriod{10'000'000};  // and the longest wait of each
constexpr Duration kLead{200'000};       // of a swap of so many
constexpr int kPriority = 50;

/// Passes all on to threads, and notes when a change is published: its coordinator asks for urgency
/// before the first store, and wakes the first member after the decision.
class Observing final : public exec::Runner {
 public:
  [[nodiscard]] const mauve::Clock& clock() const override { return threads_->clock(); }
  mauve::Status add(exec::Task& task, const mauve::rt::ThreadAttributes& attributes) override {
    return threads_->add(task, attributes);
  }
  void settle() override { threads_->settle(); }
  void open() override { threads_->open(); }
  [[nodiscard]] Duration lead(std::size_t count) const override { return threads_->lead(count); }
  void wake(exec::Task& task) override {
    if (decided_ == 0) decided_ = now();
    threads_->wake(task);
    woken_ = now();
  }
  bool await(const std::function<bool()>& condition, Instant deadline) override {
    return threads_->await(condition, deadline);
  }
  [[nodiscard]] std::shared_ptr<void> raise_priority() override {
    std::shared_ptr<void> urgency = threads_->raise_priority();
    decided_ = 0;
    begun_ = now();
    return urgency;
  }
  [[nodiscard]] bool is_fifo(const exec::Task& task, int priority) const override {
    return threads_->is_fifo(task, priority);
  }
  mauve::Status reschedule(exec::Task& task, int priority, const std::vector<int>& cpus) override {
    return threads_->reschedule(task, priority, cpus);
  }
  bool end(exec::Task& task, Instant deadline) override { return threads_->end(task, deadline); }
  void look_again() override { threads_->look_again(); }
  [[nodiscard]] bool has_abandoned(const exec::Task* task,
                                   const mauve::CoreBase* core) const override {
    return threads_->has_abandoned(task, core);
  }

  /// Of the last attempt: from the first store until the decision, and from there until the last
  /// member was woken. ns.
  [[nodiscard]] Instant publishing() const { return decided_ - begun_; }
  [[nodiscard]] Instant waking() const { return woken_ - decided_; }

 private:
  std::unique_ptr<exec::Runner> threads_ = exec::make_threads();
  Instant begun_ = 0;
  Instant decided_ = 0;
  Instant woken_ = 0;
};

struct Samples {
  std::vector<double> publishing;  // us
  std::vector<double> waking;      // us
  std::vector<double> pauses;      // ns, of all members
  std::vector<double> in_force;    // ms, from the request until the last member
  std::vector<double> answered;    // ms, until the coordinator knows
  std::size_t apart = 0;           // transactions in which the machine was disturbed
  std::size_t again = 0;           // attempts that missed their instant
  std::uint64_t missed = 0;        // releases, the disturbed ones apart
};

/// When the last of all members took its new elements; 0: not all have reported.
Instant last_in_force(exec::System& system) {
  Instant last = 0;
  std::size_t reported = 0;
  exec::drain_events(system, [&](const mauve::RuntimeEvent& happening) {
    if (happening.event != "swapped") return;
    ++reported;
    last = std::max(last, happening.time);
  });
  return reported == kMembers ? last : 0;
}

bool disturbed(const Probe& probe, Instant from, Instant to) {
  std::this_thread::sleep_for(2 * Probe::kPeriod);
  for (const int cpu : mauve::rt::usable_cpus()) {
    for (Instant at = from; at <= to; at += Probe::kPeriod.count()) {
      if (probe.disturbed(cpu, at)) return true;
    }
  }
  return false;
}

void one_transaction(exec::System& system, const Observing& runner, const Probe& probe,
                     const mauve::Change& change, Samples& samples) {
  mauve::PreparedChange prepared = checked(exec::prepare_change(system, change));
  const Instant request = now();
  const auto commit = exec::begin_commit(system, prepared);
  system.runner->await([&] { return commit->advance(); }, exec::kNever);
  const Instant answered = now();
  const mauve::Receipt receipt = checked(commit->result());
  const Instant last = last_in_force(system);
  samples.again += receipt.attempts - 1;
  if (last == 0 || disturbed(probe, request, answered)) {
    ++samples.apart;
    return;
  }
  samples.publishing.push_back(static_cast<double>(runner.publishing()) / 1e3);
  samples.waking.push_back(static_cast<double>(runner.waking()) / 1e3);
  samples.in_force.push_back(static_cast<double>(last - request) / 1e6);
  samples.answered.push_back(static_cast<double>(answered - request) / 1e6);
  for (const mauve::MemberReceipt& member : receipt.components) {
    samples.pauses.push_back(static_cast<double>(member.pause.count()));
    samples.missed += member.missed;
  }
}

Samples transactions(int count, int coordinator) {
  CountingMany architecture(kMembers, kPeriod);
  exec::System system(architecture, {});
  const auto runner = std::make_shared<Observing>();
  system.runner = runner;
  must(exec::bring_up(system));
  const Probe probe(system.t0 + Probe::kPeriod.count() / 2);
  const OnCpu here(coordinator, 0);
  std::this_thread::sleep_for(3 * kPeriod);  // the probe watches, and every component has run
  Samples samples;
  const std::array<mauve::Change, 2> changes{architecture.to<2>(), architecture.to<1>()};
  for (int i = 0; i < count; ++i) {
    one_transaction(system, *runner, probe, changes[static_cast<std::size_t>(i) % 2], samples);
  }
  static_cast<void>(exec::bring_down(system, std::chrono::seconds(2)));
  return samples;
}

struct alignas(64) Mailbox {
  std::atomic<const int*> content{nullptr};
};

/// As many mailboxes, emptied on another CPU in between, and one word that decides. us of each.
std::vector<double> raw_publications(int count, Places places) {
  std::array<Mailbox, kMembers> mailboxes;
  const int content = 0;
  const RawLoop emptying(places.component, fifo_or_none(kPriority), now() + 1'000'000,
                         Duration{1'000'000}, [&](Instant) {
                           for (Mailbox& mailbox : mailboxes) {
                             if (mailbox.content.load(std::memory_order_acquire) == nullptr)
                               continue;
                             mailbox.content.store(nullptr, std::memory_order_release);
                           }
                         });
  const OnCpu here(places.coordinator, 0);
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    std::atomic<std::uint32_t> decision{0};
    std::uint32_t undecided = 0;
    const Instant begin = now();
    for (Mailbox& mailbox : mailboxes) mailbox.content.store(&content, std::memory_order_release);
    decision.compare_exchange_strong(undecided, 1, std::memory_order_acq_rel);
    times.push_back(static_cast<double>(now() - begin) / 1e3);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return times;
}

void run(const Options& options) {
  Report report(
      "transaction",
      "A transaction over 100 components of 10 ms on all CPUs, each of which gets another "
      "core and hands 8 B of state over. Publishing: from the coordinator's first store "
      "until the decision; raw: 100 stores into mailboxes that another CPU empties, and "
      "one compare-and-swap. Apply: pause of each member as the receipts say; raw: the "
      "exchange of one pointer. Commit: from the request (the new cores are prepared) "
      "until the last member runs with its new core; the target is the lead of 200 us "
      "and the longest wait.",
      options);
  const double longest = static_cast<double>((kLead + kPeriod).count()) / 1e6;
  Figure& publishing = report.figure("publish to 100, p50", "us", at_most(10));
  Figure& publishing99 = report.figure("publish to 100, p99", "us");
  Figure& waking = report.figure("wake 100 afterwards, p50", "us");
  Figure& apply = report.figure("apply of one of 100, p50", "ns", at_most(300));
  Figure& apply99 = report.figure("apply of one of 100, p99", "ns");
  Figure& in_force = report.figure("commit, last of 100 in force, p50", "ms", at_most(longest));
  Figure& in_force99 = report.figure("commit, last of 100 in force, p99", "ms", at_most(longest));
  Figure& answered = report.figure("commit, receipt of 100 in hand, p50", "ms");
  const int count = options.choose(100, 10);
  const Places places{mauve::rt::usable_cpus().back(), mauve::rt::usable_cpus().front()};
  std::size_t apart = 0;
  std::size_t again = 0;
  std::uint64_t missed = 0;
  for (int i = 0; i < options.rounds; ++i) {
    const Samples ours = transactions(count, places.coordinator);
    const auto raw = raw_publications(count, places);
    const auto raw_pauses = raw_exchanges(places, kPriority, count);
    publishing.add(median(ours.publishing), median(raw));
    publishing99.add(percentile(ours.publishing, 99), percentile(raw, 99));
    waking.add(median(ours.waking));
    apply.add(median(ours.pauses), median(raw_pauses));
    apply99.add(percentile(ours.pauses, 99), percentile(raw_pauses, 99));
    in_force.add(median(ours.in_force));
    in_force99.add(percentile(ours.in_force, 99));
    answered.add(median(ours.answered));
    apart += ours.apart;
    again += ours.again;
    missed += ours.missed;
  }
  report.note(std::to_string(count * options.rounds) + " transactions, " + std::to_string(apart) +
              " of them set apart, in which a SCHED_FIFO 99 probe was itself over 200 us late; " +
              std::to_string(missed) + " releases missed by the others; " + std::to_string(again) +
              " attempts missed their instant and were repeated.");
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
