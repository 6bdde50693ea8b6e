// SPDX-License-Identifier: LGPL-3.0-or-later
// Many clients at once on a mauved whose components are real-time threads.
#include <array>
#include <atomic>
#include <deque>
#include <thread>

#include "rt/thread/thread.h"
#include "support/crowd.h"
#include "support/missed_releases.h"
#include "support/sanitized.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

constexpr std::int64_t kLongestPeriod = 5'000'000;
constexpr int kValues = 300;  // of each who watches
constexpr int kAnswers = 20;  // for each client that asks

/// The first component writes a gain of 0, and then the number of its job. Both are above other
/// people's real-time threads, which a probe above all does not see.
std::string counting_first() {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["components"]["first"]["core"] = "trial/counting";
  architecture["components"]["first"]["properties"]["core.gain"] = 0.0;
  for (auto& component : architecture["components"]) {
    component["task"] = {{"priority", 90}, {"budget", "1ms"}};  // how fast they are is not tested
  }
  return architecture.dump();
}

struct Watched {
  int values = 0;
  int backwards = 0;  ///< numbers that are not above the one before
  bool ended = false;
};

/// Takes every value that the output is given until it had enough.
Watched watch(RawClient& client) {
  Watched watched;
  const auto done = client.ask("watch.subscribe", {{"addresses", {"signal.read"}}});
  double before = -1;
  while (done.contains("result") && watched.values < kValues) {
    const auto notification = client.notification("value");
    if (notification.is_null()) return watched;
    const auto value = notification["params"]["value"].get<double>();
    if (value == 0) continue;
    if (value <= before) ++watched.backwards;
    before = value;
    ++watched.values;
  }
  watched.ended = done.contains("result");
  return watched;
}

/// Asks for statistics and status in turn; the answers that list both components.
int ask(RawClient& client) {
  int answers = 0;
  for (int i = 0; i < kAnswers; ++i) {
    const auto answer = client.ask(i % 2 == 0 ? "stats.get" : "status.get");
    if (!answer.contains("result")) return answers;
    if (answer["result"]["components"].size() == 2) ++answers;
  }
  return answers;
}

/// Of both components, since they began.
std::uint64_t missed(const Json& status) {
  std::uint64_t all = 0;
  for (const auto& row : status["components"]) all += row["missed"].get<std::uint64_t>();
  return all;
}

TEST(Watchers, ThirtyTwoAtOnceCostNoRelease) {
  if (!Crowd::possible()) GTEST_SKIP() << "SKIPPED: " << Crowd::kNotPossible;
  constexpr std::size_t kHalf = 16;
  const TempDir place;
  TrialDaemon daemon(counting_first(), {"--realtime", "prefer"},
                     Crowd(place.path(), MAUVE_BIN_DIR "/mauved").program());
  // While it is on there are probes, which measure what something foreign held up.
  ASSERT_EQ(daemon.ask("trace.start", {{"seconds", 60}})["on"], true);
  const auto first = daemon.ask("status.get");
  const auto before = daemon.ask("status.get");
  std::deque<RawClient> clients;
  for (std::size_t i = 0; i < 2 * kHalf; ++i) {
    clients.push_back(Crowd::client(daemon.socket(), i));
  }
  ASSERT_EQ(daemon.ask("client.list")["items"].size(), 2 * kHalf + 1) << "and who asks for it";

  std::array<Watched, kHalf> watched;
  std::array<int, kHalf> answers{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kHalf; ++i) {
    threads.emplace_back([&, i] { watched[i] = watch(clients[i]); });
    threads.emplace_back([&, i] { answers[i] = ask(clients[kHalf + i]); });
  }
  for (auto& thread : threads) thread.join();
  const auto after = daemon.ask("status.get");

  for (const auto& one : watched) {
    EXPECT_TRUE(one.ended && one.values == kValues) << one.values;
    EXPECT_EQ(one.backwards, 0);
  }
  EXPECT_THAT(answers, testing::Each(kAnswers));
  if (!rt::may_use_fifo(99)) {
    GTEST_SKIP() << "SKIPPED the releases: no SCHED_FIFO here, so others may hold them up";
  }
  ASSERT_EQ(after["realtime"], true);
  const auto trace = place / "all.mtrace";
  ASSERT_EQ(Process({MAUVE_BIN_DIR "/mauvectl", "--socket", daemon.socket().string(), "trace",
                     "dump", "-o", trace.string()})
                .wait(),
            0);
  const auto last = daemon.ask("status.get");
  const auto traced_since = [&](const auto& status) {
    return missed_releases(trace, status["t_ns"].template get<std::int64_t>(), kLongestPeriod);
  };
  const auto traced = traced_since(first);
  ASSERT_LE(traced.from, first["t_ns"].get<std::int64_t>())
      << "the trace does not reach back to where they began";
  EXPECT_EQ(traced.missed, 0U) << traced.disturbed << " more were disturbed";
  // A release may be missed while a status is read, or between the last status and the trace.
  EXPECT_LE(missed(after) - missed(before), traced.disturbed) << "one is not in the trace";
  EXPECT_GE(missed(last) - missed(first), traced_since(before).disturbed) << "one is not counted";
}

TEST(Watchers, WithAllTheirSubscriptionsDoNotHoldUpAStop) {
  constexpr std::size_t kClients = 7;
  constexpr int kSubscriptions = support::kSanitized ? 16 : 64;
  TrialDaemon daemon(counting_first());
  std::deque<RawClient> clients;
  for (std::size_t i = 0; i < kClients; ++i) clients.push_back(daemon.client());
  std::atomic<int> open{0};
  std::vector<std::jthread> readers;
  for (auto& client : clients) {
    readers.emplace_back([&](const std::stop_token& end) {
      for (int i = 0; i < kSubscriptions; ++i) {
        if (client.ask("watch.subscribe", {{"addresses", {"signal.read"}}}).contains("result"))
          ++open;
      }
      while (!end.stop_requested() && client.line()) {
      }
    });
  }
  EXPECT_TRUE(eventually([&] { return open == kSubscriptions * static_cast<int>(kClients); }));
  auto operating = daemon.client();

  const auto stopped = operating.ask("component.stop", {{"components", {"second"}}});

  EXPECT_EQ(stopped["result"]["state"], "applied") << stopped;
  EXPECT_EQ(operating.ask("client.list")["result"]["items"].size(), kClients + 1)
      << "they watch on";
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
