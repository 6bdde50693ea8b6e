// SPDX-License-Identifier: LGPL-3.0-or-later
/// stats.get, stats.reset and metrics.get of a simulated system.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "commands/table.h"
#include "rt/time/measured.h"
#include "support/ramp.h"
#include "unit/daemon/front.h"

namespace mauve::daemon {
namespace {

using server::Role;
using testing::HasSubstr;

/// Two components at 10 ms.
class Statistics : public Front<ramp::Two<ramp::Up>> {
 protected:
  void SetUp() override {
    architecture.left.task().budget = 1ms;
    Front::SetUp();
    deployer.run_for(100ms);
  }

  Json answer(const std::string& method, Json params = Json::object()) {
    auto outcome = ask(Role::operator_, method, std::move(params));
    const auto* result = std::get_if<Json>(&outcome);
    EXPECT_NE(result, nullptr) << method;
    return result == nullptr ? Json() : *result;
  }
  std::uint64_t jobs(const char* component) {
    return answer("stats.get", {{"address", component}})["components"][0]["lateness"]["count"];
  }
};

TEST_F(Statistics, ListAllComponentsWithoutTheirStates) {
  const auto result = answer("stats.get");

  ASSERT_EQ(result["components"].size(), 2U);
  const auto& left = result["components"][0];
  EXPECT_EQ(result["t_ns"], deployer.clock().now() - deployer.t0());
  EXPECT_EQ(left["name"], "left");
  EXPECT_EQ(left["budget_ns"], 1'000'000);
  EXPECT_FALSE(left.contains("states"));
  EXPECT_EQ(left["lateness"]["count"], 10);
  EXPECT_EQ(left["response"]["max_ns"], 0) << "a simulated job takes no time";
  for (const auto* key : {"mean_ns", "min_ns", "p50_ns", "p90_ns", "p99_ns", "p99_9_ns"}) {
    EXPECT_TRUE(left["response"][key].is_number()) << key;
  }
  EXPECT_EQ(left["lock_waits"], (Json{{"count", 0}, {"sum_ns", 0}, {"max_ns", nullptr}}));
}

TEST_F(Statistics, ShowOneComponentWithItsStatesOrOneOfThem) {
  const auto whole = answer("stats.get", {{"address", "left"}})["components"][0];
  const auto state = answer("stats.get", {{"address", "left.update"}})["components"][0];

  ASSERT_EQ(whole["states"].size(), 1U);
  EXPECT_EQ(whole["states"], state["states"]);
  EXPECT_EQ(whole["states"][0]["name"], "update");
  const auto& times = whole["states"][0];
  EXPECT_EQ(times["execution"]["count"].get<int>() + times["preempted"]["count"].get<int>(), 10);
}

TEST_F(Statistics, SayWhatIsNeitherComponentNorState) {
  const auto component = refused(Role::viewer, "stats.get", {{"address", "lefd"}});
  const auto state = refused(Role::viewer, "stats.get", {{"address", "left.updat"}});

  EXPECT_EQ(component.name, "unknown_name");
  EXPECT_EQ(state.where, "left.updat");
  EXPECT_THAT(state.hint, HasSubstr("update"));
}

TEST_F(Statistics, AreResetByAnOperatorOfOneOrAll) {
  EXPECT_EQ(refused(Role::viewer, "stats.reset", {{"component", "left"}}).name, "not_permitted");
  EXPECT_EQ(refused(Role::operator_, "stats.reset", {{"component", "lefd"}}).name, "unknown_name");
  EXPECT_EQ(jobs("left"), 10U);

  const auto one = answer("stats.reset", {{"component", "left"}});
  EXPECT_EQ(one["components"], Json::parse(R"([{"name": "left"}])"));
  EXPECT_EQ(jobs("left"), 0U);
  EXPECT_EQ(jobs("right"), 10U);
  EXPECT_EQ(answer("stats.reset")["components"].size(), 2U);
  EXPECT_EQ(jobs("right"), 0U);
}

TEST_F(Statistics, AreResetUnderAnyLockAndThatIsNoChange) {
  running.failures.changed({"left"}, {7, "now", "param.set", 1000, "faster"});
  running.lock = Lock::all;

  EXPECT_EQ(answer("stats.reset")["state"], "applied");

  EXPECT_EQ(jobs("left"), 0U);
  const auto change = answer("component.why", {{"component", "left"}})["change"];
  EXPECT_EQ(change["method"], "param.set") << change;
}

/// "name{labels}" -> value, and what HELP and TYPE say of each family. Refuses what the format does
/// not allow.
struct Exposition {
  std::map<std::string, double> samples;
  std::map<std::string, std::string> types;

  explicit Exposition(const std::string& text) {
    EXPECT_TRUE(text.ends_with('\n'));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) read(line);
  }

  void read(const std::string& line) {
    if (line.rfind("# HELP ", 0) == 0) {
      family_ = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_GT(line.size(), 8 + family_.size()) << line;
      return;
    }
    if (line.rfind("# TYPE ", 0) == 0) {
      EXPECT_EQ(line.substr(7, family_.size()), family_) << "TYPE follows HELP";
      EXPECT_TRUE(types.emplace(family_, line.substr(8 + family_.size())).second)
          << family_ << ": a family stands together";
      return;
    }
    const auto space = line.rfind(' ');
    ASSERT_NE(space, std::string::npos) << line;
    const auto key = line.substr(0, space);
    const auto name = key.substr(0, key.find('{'));
    const auto suffix = name.substr(std::min(family_.size(), name.size()));
    EXPECT_EQ(name.substr(0, family_.size()), family_) << line;
    const bool histogram = types[family_] == "histogram";
    EXPECT_EQ(suffix.empty(), !histogram) << line;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), name.npos) << line;
    if (types[family_] == "counter") {
      EXPECT_TRUE(name.ends_with("_total")) << name;
    }
    EXPECT_TRUE(samples.emplace(key, std::stod(line.substr(space + 1))).second) << key;
  }

 private:
  std::string family_;
};

TEST_F(Statistics, AreMetricsThatPrometheusReads) {
  const Exposition page(answer("metrics.get")["text"]);

  EXPECT_EQ(page.samples.at(R"(mauve_releases_total{component="left"})"), 10);
  EXPECT_EQ(page.samples.at(R"(mauve_component_running{component="right"})"), 1);
  EXPECT_EQ(page.samples.at(R"(mauve_budget_seconds{component="left"})"), 0.001);
  EXPECT_EQ(page.samples.count(R"(mauve_budget_seconds{component="right"})"), 0U);
  EXPECT_EQ(page.samples.at(R"(mauve_state_runs_total{component="left",state="update"})"), 10);
  EXPECT_EQ(page.types.at("mauve_response_seconds"), "histogram");
  EXPECT_EQ(page.samples.at(R"(mauve_response_seconds_bucket{component="left",le="+Inf"})"), 10);
  EXPECT_EQ(page.samples.at(R"(mauve_response_seconds_count{component="left"})"), 10);
  EXPECT_EQ(page.samples.at(R"(mauve_response_seconds_bucket{component="left",le="1.024e-06"})"),
            10);
}

TEST_F(Statistics, CountEachBucketOfAMetricWithThoseBefore) {
  const Exposition page(answer("metrics.get")["text"]);
  const std::string begin = R"(mauve_start_lateness_seconds_bucket{component="left",le=")";
  std::map<double, double> buckets;
  for (const auto& [key, value] : page.samples) {
    if (key.rfind(begin, 0) == 0) buckets[std::stod(key.substr(begin.size()))] = value;
  }

  EXPECT_EQ(buckets.size(), 13U) << "12 powers of four, and all";
  double last = 0;
  for (const auto& [bound, count] : buckets) {
    EXPECT_GE(count, last) << bound;
    last = count;
  }
  EXPECT_EQ(last, 10);
}

TEST_F(Statistics, EscapeLabelsOfMetrics) {
  Architecture odd{"a \"b\" \\ c"};
  Deployer idle{odd, {Realtime::off, true}};
  ASSERT_TRUE(idle.deploy());
  Running other{odd,     idle,       catalog,         control, log,
                watches, supervisor, running.clients, "b008",  running.since};
  CommandTable its_table{other};
  auto answered = std::make_shared<std::promise<server::Outcome>>();
  auto outcome = answered->get_future();
  its_table.dispatch({1, {100, 1000, {}}, Role::viewer, outbox},
                     *protocol::find_method("metrics.get"), {1, "metrics.get", Json::object()},
                     [answered](server::Outcome out) { answered->set_value(std::move(out)); });
  const auto result = std::get<Json>(outcome.get());

  EXPECT_THAT(result["text"].get<std::string>(),
              HasSubstr(R"(mauve_info{architecture="a \"b\" \\ c",)"));
}

/// Each of 1000 jobs is as long as one of four, which no bucket puts together.
TEST_F(Statistics, ShowHowLongTheLongestOfEachShareTook) {
  static_cast<void>(answer("stats.reset"));
  auto& response = architecture.left.bundle()->measured->here().response;
  for (const auto& [jobs, time] : {std::pair{600, 1ms}, {350, 2ms}, {45, 4ms}, {5, 8ms}}) {
    for (int i = 0; i < jobs; ++i) response.add(Duration{time}.count());
  }

  const auto left = answer("stats.get", {{"address", "left"}})["components"][0]["response"];

  const auto near = [&](const char* key, double milliseconds) {
    EXPECT_NEAR(left[key].get<double>(), milliseconds * 1e6, milliseconds * 0.04e6) << key;
  };
  near("p50_ns", 1);
  near("p90_ns", 2);
  near("p99_ns", 4);
  near("p99_9_ns", 8);
}

TEST_F(Statistics, MetricsCountRequestsRefusalsAndWhatTheSystemDidByItself) {
  static_cast<void>(answer("status.get"));
  static_cast<void>(answer("status.get"));
  static_cast<void>(refused(Role::viewer, "stats.get", {{"address", "lefd"}}));
  for (const auto kind : {Outcome::Kind::rolled_back, Outcome::Kind::rolled_back,
                          Outcome::Kind::fell_back, Outcome::Kind::restarted}) {
    Outcome outcome;
    outcome.kind = kind;
    outcome.component = "left";
    running.counts.note(outcome);
  }

  auto page = Exposition(answer("metrics.get")["text"]).samples;

  EXPECT_EQ(page.at(R"(mauve_commands_total{method="status.get"})"), 2);
  EXPECT_EQ(page.at(R"(mauve_commands_total{method="stats.get"})"), 1);
  EXPECT_EQ(page.at(R"(mauve_refusals_total{method="stats.get",error="unknown_name"})"), 1);
  EXPECT_EQ(page.at(R"(mauve_rollbacks_total{component="left"})"), 2);
  EXPECT_EQ(page.at(R"(mauve_fallbacks_total{component="left"})"), 1);
  EXPECT_EQ(page.at(R"(mauve_restarts_total{component="left"})"), 1);
  EXPECT_EQ(page.at(R"(mauve_restarts_total{component="right"})"), 0) << "a series begins with 0";
  EXPECT_EQ(page.at(R"(mauve_faults_total{component="left"})"), 0);
}

}  // namespace
}  // namespace mauve::daemon
