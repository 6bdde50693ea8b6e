// SPDX-License-Identifier: LGPL-3.0-or-later
// Changes that meet each other, a client that dies, or a slow hook.
#include <algorithm>
#include <filesystem>
#include <thread>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// A request that nobody waits for yet.
[[nodiscard]] RawClient asking(TrialDaemon& daemon, const std::string& method, const Json& params) {
  auto client = daemon.client();
  EXPECT_TRUE(client.send(protocol::to_line(protocol::make_request(7, method, params)) + '\n'));
  return client;
}

/// `first` begins to be swapped to a core that takes its time.
[[nodiscard]] RawClient slow_swap(TrialDaemon& daemon, const std::string& time) {
  const auto marker = daemon.place() / "begun";
  auto client = asking(daemon, "core.swap",
                       {{"component", "first"},
                        {"core", "trial/slow"},
                        {"probation", "off"},
                        {"set", {{"configure_time", time}, {"marker", marker.string()}}}});
  EXPECT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));
  return client;
}

Json gain_of(const std::string& component, double value, const Json& more = Json::object()) {
  Json params = {{"values", {{component + ".core.gain", value}}}};
  params.update(more);
  return params;
}

std::int64_t on_grid(const Json& component) {
  return component["releases"].get<std::int64_t>() + component["missed"].get<std::int64_t>();
}

TEST(Swap, ChangesNothingWhenAHookThrowsWhatIsNoException) {
  TrialDaemon daemon;

  const auto error =
      daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/throwing_anything"}});

  EXPECT_EQ(error["data"]["name"], "hook_threw") << error;
  EXPECT_EQ(error["data"]["state"], "unchanged");
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("no std::exception"));
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
}

TEST(Swap, SurvivesAnExceptionWithoutATextInAHookAndInAJob) {
  TrialDaemon daemon;
  Json swap = {{"component", "first"}, {"core", "trial/throwing_no_text"}};

  const auto error = daemon.ask("core.swap", swap);

  EXPECT_EQ(error["data"]["name"], "hook_threw") << error;
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("an exception without a text"));
  swap["set"] = {{"in_job", true}};
  EXPECT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  EXPECT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }))
      << "rolled back";
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Swap, KeepsTheReleaseGridWhenConfigureTakesFiveSeconds) {
  TrialDaemon daemon;
  auto client = slow_swap(daemon, "5s");
  const auto begun = daemon.component("first");
  const auto four_seconds_on = on_grid(begun) + 2000;
  ASSERT_TRUE(eventually([&] { return on_grid(daemon.component("first")) > four_seconds_on; }));
  const auto during = daemon.component("first");
  EXPECT_EQ(during["core"], "trial/steady");
  EXPECT_GT(during["releases"], begun["releases"]);
  EXPECT_FALSE(client.line(std::chrono::milliseconds(0)).has_value()) << "it is still configured";

  const auto receipt = client.json()["result"];

  EXPECT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_EQ(daemon.component("first")["core"], "trial/slow");
  const auto counters = daemon.ask("object.get", {{"address", "first"}})["counters"];
  EXPECT_EQ(counters["next_release_ns"].get<std::int64_t>() % 2'000'000, 0);
}

TEST(Race, TwoClientsAreServedOneAfterTheOther) {
  constexpr int kChanges = 20;
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  std::vector<std::vector<std::int64_t>> generations(2);
  std::vector<std::thread> clients;
  for (std::size_t i = 0; i < generations.size(); ++i) {
    clients.emplace_back([&daemon, &mine = generations[i]] {
      RawClient client(daemon.socket());
      for (int n = 0; n < kChanges; ++n) {
        const auto core = n % 2 == 0 ? "trial/other" : "trial/counting";
        const auto answer =
            client.ask("core.swap", {{"component", "first"}, {"core", core}, {"probation", "off"}});
        if (answer.contains("result")) mine.push_back(answer["result"]["generation"]);
      }
    });
  }
  for (auto& client : clients) client.join();

  std::vector<std::int64_t> all;
  for (const auto& mine : generations) {
    EXPECT_EQ(mine.size(), static_cast<std::size_t>(kChanges));
    EXPECT_TRUE(std::is_sorted(mine.begin(), mine.end()));
    all.insert(all.end(), mine.begin(), mine.end());
  }
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i], static_cast<std::int64_t>(i) + 2) << "each has one of its own";
  }
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2 * kChanges + 1);
}

TEST(Race, OneOfTwoClientsWinsWhenBothExpectTheSameGeneration) {
  TrialDaemon daemon;
  auto busy = slow_swap(daemon, "1s");  // both wait behind it, whoever comes first
  auto one = asking(daemon, "param.set", gain_of("second", 2.0, {{"if_generation", 2}}));
  auto other = asking(daemon, "param.set", gain_of("second", 3.0, {{"if_generation", 2}}));

  EXPECT_EQ(busy.json()["result"]["generation"], 2);
  const auto first = one.json();
  const auto second = other.json();

  EXPECT_NE(first.contains("result"), second.contains("result")) << first << second;
  const auto& lost = first.contains("result") ? second : first;
  EXPECT_EQ(lost["error"]["data"]["name"], "conflict");
  EXPECT_EQ(daemon.ask("status.get")["generation"], 3);
  EXPECT_EQ(daemon.value("second.core.gain"), first.contains("result") ? 2.0 : 3.0);
}

TEST(Race, AChangeWhoseClientIsKilledIsCarriedOutAndTheNextOneWorks) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());  // it is up
  const auto marker = (daemon.place() / "begun").string();
  Process client(mauvectl_words(daemon.socket().string(),
                                {"swap-core", "first", "trial/slow", "--probation", "off", "--set",
                                 "configure_time=1s", "--set", "marker=" + marker}));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));

  client.signal(SIGKILL);
  EXPECT_EQ(client.wait(), 128 + SIGKILL) << "it was still waiting";

  EXPECT_EQ(daemon.ask("param.set", gain_of("second", 2.0))["generation"], 3);
  EXPECT_EQ(daemon.component("first")["core"], "trial/slow");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

constexpr const char* kEmpty = R"({ "schema": "mauve/architecture/1", "name": "race",
    "components": {} })";

/// One that adds two components of the plugin; the first gets ready slowly.
std::string two_components(const TrialDaemon& daemon, const std::string& core_of_second) {
  return R"({ "schema": "mauve/architecture/1", "name": "race", "plugins": ["trial"],
    "components": {
      "a": { "type": "trial/unit", "core": "trial/slow", "properties": {
             "core.marker": ")" +
         (daemon.place() / "begun").string() + R"(" } },
      "b": { "type": "trial/unit", "core": "trial/)" +
         core_of_second + R"(" } } })";
}

TEST(Race, APluginIsNotUnloadedWhileAChangeIsPreparedWithIt) {
  TrialDaemon daemon(kEmpty);
  ASSERT_EQ(daemon.ask("plugin.load", {{"plugin", "trial"}})["loaded"], true);
  auto applying = asking(daemon, "architecture.apply", {{"text", two_components(daemon, "other")}});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(daemon.place() / "begun"); }));

  const auto unload = daemon.ask("plugin.unload", {{"plugin", "trial"}});

  EXPECT_EQ(applying.json()["result"]["state"], "applied");
  EXPECT_THAT(unload["message"].get<std::string>(), HasSubstr("a.core (trial/slow)"));
  EXPECT_EQ(daemon.component("a")["state"], "running");
}

TEST(Race, APluginIsUnloadedWhenTheChangeThatWasPreparedWithItIsRefused) {
  TrialDaemon daemon(kEmpty);
  ASSERT_EQ(daemon.ask("plugin.load", {{"plugin", "trial"}})["loaded"], true);
  auto applying =
      asking(daemon, "architecture.apply", {{"text", two_components(daemon, "refusing")}});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(daemon.place() / "begun"); }));

  const auto unload = daemon.ask("plugin.unload", {{"plugin", "trial"}});

  EXPECT_EQ(applying.json()["error"]["data"]["state"], "unchanged");
  EXPECT_EQ(unload["unmapped"], true) << unload;
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
}

TEST(Generation, IsAskedForByEveryChange) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("param.set", gain_of("first", 3.0))["generation"], 2);
  std::vector<std::pair<std::string, Json>> changes = {
      {"param.set", gain_of("first", 3.0)},
      {"component.start", {{"components", {"first"}}}},
      {"component.stop", {{"components", {"first"}}}},
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}}},
      {"port.connect", {{"port", "second.ports.input"}, {"service", "signal.read"}}},
      {"port.disconnect", {{"port", "second.ports.input"}}},
      {"plugin.load", {{"plugin", "trial"}}},
      {"plugin.unload", {{"plugin", "trial"}}},
      {"plugin.reload", {{"plugin", "trial"}}},
      {"config.rollback", {{"generation", 1}}},
      {"lock.set", {{"lock", "all"}}}};

  for (auto& [method, params] : changes) {
    params["if_generation"] = 1;
    const auto error = daemon.ask(method, params);
    EXPECT_EQ(error["data"]["exit"], 6) << method << error;
    EXPECT_THAT(
        error["message"].get<std::string>(),
        HasSubstr("2 is running, made by uid " + std::to_string(geteuid()) + " with param.set"));
  }
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2);
}

}  // namespace
}  // namespace mauve::test
