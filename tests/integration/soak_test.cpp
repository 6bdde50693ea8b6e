// SPDX-License-Identifier: LGPL-3.0-or-later
/// Nothing is used up: MAUVE_SOAK_SECONDS (10) of changes of all kinds and of viewers that come and
/// go, in an order that MAUVE_SEED decides. Memory, descriptors and threads of mauved stay level.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include "changeable_systems.h"
#include "support/number_in.h"
#include "support/process_usage.h"
#include "support/sanitized.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using std::chrono::steady_clock;

/// The length from which the tight bounds hold: a short form has not warmed up.
constexpr std::uint64_t kWarm = 600;

/// The memory, descriptors and threads of mauved at one moment.
struct Usage {
  std::int64_t bytes = 0;
  std::int64_t descriptors = 0;
  std::int64_t threads = 0;
  std::int64_t operations = 0;  ///< so far: changes, and visits of viewers
  std::int64_t changes = 0;
};

Usage usage_of(pid_t process, std::uint64_t operations, std::uint64_t changes) {
  return {resident_bytes(process), static_cast<std::int64_t>(entries(process, "fd")),
          static_cast<std::int64_t>(entries(process, "task")),
          static_cast<std::int64_t>(operations), static_cast<std::int64_t>(changes)};
}

/// The median of each figure between these shares of the samples.
Usage median(const std::vector<Usage>& samples, double from, double to) {
  const auto at = [&](double share) {
    return static_cast<std::size_t>(share * static_cast<double>(samples.size()));
  };
  const auto of = [&](std::int64_t Usage::*figure) {
    std::vector<std::int64_t> values;
    for (std::size_t i = at(from); i < std::max(at(to), at(from) + 1); ++i) {
      values.push_back(samples.at(i).*figure);
    }
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  return {of(&Usage::bytes), of(&Usage::descriptors), of(&Usage::threads), of(&Usage::operations),
          of(&Usage::changes)};
}

/// The kinds of changes that end well or are refused. A core that hangs costs its thread, and while
/// that lives nothing that it may be in is freed; a hook that crashes costs the memory that it
/// held. Both are reported, and neither is a leak of mauved.
ChangeableSystem sound_system() {
  auto system = trial_system();
  system.hangs.clear();
  system.values.erase("meter.core.breaks_at");  // the meter keeps its caller at that value
  system.file["resources"]["meter"]["properties"]["core.breaks_at"] = 1e9;
  for (auto& [component, cores] : system.cores) {
    std::erase_if(cores, [](const std::string& core) {
      return core == "trial/crashing_hook" || core == "trial/leaving_hook" || core == "trial/slow";
    });
  }
  return system;
}

class Soak : public testing::Test {
 protected:
  /// Sends changes until the time is over, and samples beside them.
  void change(TrialDaemon& daemon) {
    ChangeGenerator generator(sound_system(), seed_);
    auto client = std::make_unique<RawClient>(daemon.client());
    const auto every =
        std::chrono::milliseconds(std::clamp<std::uint64_t>(seconds_ * 2, 200, 5000));
    const auto begin = steady_clock::now();
    for (auto next = begin; steady_clock::now() - begin < std::chrono::seconds(seconds_);) {
      auto request = generator.next();
      if (request.install != 0) daemon.install(request.install);
      if (request.back >= 0) request.params["generation"] = generation_behind(*client, request);
      const auto answer = client->ask(request.method, request.params);
      ASSERT_TRUE(answer.is_object()) << request.to_json() << ", seed " << seed_ << daemon.errors();
      ++(answer.contains("result") ? applied_ : refused_);
      ++operations_;
      if (steady_clock::now() < next) continue;
      samples_.push_back(usage_of(daemon.process().id(), operations_, applied_ + refused_));
      next += every;
    }
  }
  /// Comes, looks and watches, and leaves in one way or another.
  void view(TrialDaemon& daemon, const std::atomic<bool>& end) {
    std::mt19937_64 random(seed_ + 1);
    const std::vector<std::string> reads{"status.get",    "config.get",     "log.tail",
                                         "metrics.get",   "rules.list",     "config.history",
                                         "component.why", "system.analyze", "plugin.list"};
    while (!end) {
      RawClient viewer(daemon.socket());
      if (!viewer.connected() || viewer.json().is_null()) continue;
      static_cast<void>(
          viewer.ask("watch.subscribe", {{"addresses", {"signal.read", "a.core.count"}}}));
      for (auto reads_left = random() % 4; reads_left > 0; --reads_left) {
        static_cast<void>(viewer.ask(reads[random() % reads.size()]));
      }
      if (random() % 2 == 0) static_cast<void>(viewer.ask("watch.unsubscribe", {{"sub", 1}}));
      if (random() % 2 == 0) {  // it leaves without waiting for the answer
        static_cast<void>(
            viewer.send("{\"jsonrpc\":\"2.0\",\"id\":99,\"method\":\"status.get\"}\n"));
      }
      ++operations_;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  /// A leak of one descriptor or thread in 1000 operations, or of 100 bytes in each, is twice what
  /// is allowed between the windows. Beside that there is what comes and goes: connections, the
  /// trials and judges of the moment, a page or two of a heap that is used by several threads.
  void expect_level() const {
    const auto early = median(samples_, 0.2, 0.35);
    const auto late = median(samples_, 0.85, 1.0);
    const auto between = late.operations - early.operations;
    std::printf(
        "%lu operations (%lu changes applied, %lu refused); early and late: %ld and %ld kB, %ld "
        "and %ld descriptors, %ld and %ld threads; %ld operations (%ld changes) between them\n",
        operations_.load(), applied_, refused_, early.bytes / 1024, late.bytes / 1024,
        early.descriptors, late.descriptors, early.threads, late.threads, between,
        late.changes - early.changes);
    ASSERT_GT(early.descriptors, 0);
    const bool warm = seconds_ >= kWarm;
    constexpr std::int64_t kCold = 64 << 20;  ///< a heap that still grows to its size
    const auto bytes = warm ? 50 * between : kCold;
    const auto entries = warm ? std::max<std::int64_t>(3, between / 2000) : 12;
    // Beside others that want every CPU a change may take seconds, while viewers go on.
    EXPECT_GT(applied_, warm ? operations_ / 20 : 0) << "hardly anything was changed";
    if (!support::kSanitized) {
      EXPECT_LE(late.bytes - early.bytes, bytes) << "seed " << seed_;
    }
    EXPECT_LE(late.descriptors - early.descriptors, entries) << "seed " << seed_;
    EXPECT_LE(late.threads - early.threads, entries) << "seed " << seed_;
  }
  void write_samples() const {
    for (const auto& one : samples_) {
      std::printf("%ld operations: %ld kB, %ld descriptors, %ld threads\n", one.operations,
                  one.bytes / 1024, one.descriptors, one.threads);
    }
  }

  const std::uint64_t seed_ = number_in("MAUVE_SEED", 1);
  const std::uint64_t seconds_ = number_in("MAUVE_SOAK_SECONDS", 10);
  const TempDir place_;

 private:
  static std::int64_t generation_behind(RawClient& client, const ChangeRequest& request) {
    const auto answer = client.ask("config.history", {{"n", request.back + 1}});
    const auto& items = answer["result"]["items"];
    if (!items.is_array() || items.empty()) return 1;
    return items.back()["generation"];
  }

  std::atomic<std::uint64_t> operations_{0};
  std::uint64_t applied_ = 0;
  std::uint64_t refused_ = 0;
  std::vector<Usage> samples_;
};

TEST_F(Soak, UsesNothingUp) {
  std::printf("seed %lu, %lu s\n", seed_, seconds_);
  TrialDaemon daemon(sound_system().file.dump(),
                     {"--realtime", "off", "--state-dir", (place_ / "state").string()});
  std::atomic<bool> end{false};
  static_cast<void>(daemon.client());
  std::vector<std::thread> viewers;
  for (int i = 0; i < 2; ++i) viewers.emplace_back([&] { view(daemon, end); });

  change(daemon);

  end = true;
  for (auto& viewer : viewers) viewer.join();
  write_samples();
  ASSERT_TRUE(daemon.process().running()) << daemon.errors();
  expect_level();
  daemon.process().signal(SIGTERM);
  // A sanitizer makes the end ten times as long, and mauved ends by force when its time is over.
  const bool whole = daemon.process().wait() == 0;
  const bool in_time = daemon.errors().find("it takes too long") == std::string::npos;
  EXPECT_TRUE(whole || (support::kSanitized && !in_time)) << "seed " << seed_ << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
