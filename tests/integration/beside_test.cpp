// SPDX-License-Identifier: LGPL-3.0-or-later
// Reads beside changes: whatever a viewer asks for, no thread reads what another one destroys.
#include <algorithm>
#include <atomic>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

struct Question {
  std::string method;
  Json params;
};

/// Every method that changes nothing, with arguments that let it do its work.
std::vector<Question> all_reads(TrialDaemon& daemon) {
  const std::map<std::string, Json> arguments = {{"address", "first"},
                                                 {"addresses", {"signal.read", "first.core.count"}},
                                                 {"component", "first"},
                                                 {"components", {"first"}},
                                                 {"subscription", 1},
                                                 {"sub", 1},
                                                 {"text", kTrial},
                                                 {"name", "none"},
                                                 {"file", "none"},
                                                 {"generation", 1},
                                                 {"from", 1},
                                                 {"to", 1},
                                                 {"condition", "first.core.count > 1"}};
  std::vector<Question> found;
  const Json methods = daemon.ask("command.list");
  for (const auto& row : methods["items"]) {
    if (row["mutation"] == true || row["role"] != "viewer") continue;
    Json params = Json::object();
    for (const auto& param : row["params"]) {
      const auto known = arguments.find(param["name"]);
      if (known != arguments.end()) {
        params[known->first] = known->second;
      } else {
        EXPECT_FALSE(param["required"]) << "give " << row["name"] << " an argument: " << param;
      }
    }
    found.push_back({row["name"], params});
  }
  return found;
}

/// Asks everything again and again; files are judged once. Returns the answers, errors among them;
/// a question that is not answered ends it.
int ask_all(RawClient& client, const std::vector<Question>& questions, int times) {
  int answers = 0;
  for (int i = 0; i < times; ++i) {
    for (const auto& [method, params] : questions) {
      const bool judged =
          method == "config.check" || method == "architecture.diff" || method == "config.compare";
      if (judged && i > 0) continue;  // each of them starts a process
      if (client.ask(method, params).is_null()) return answers;
      ++answers;
    }
  }
  return answers;
}

/// Every method that changes something, in an order in which most of them have something to do.
std::vector<Question> all_changes() {
  const Json off = "off";
  auto other = Json::parse(std::string(kTrial));
  other["components"]["third"] = {{"type", "trial/unit"}, {"properties", {{"fsm.period", "9ms"}}}};
  return {{"core.swap", {{"component", "first"}, {"core", "trial/other"}, {"probation", off}}},
          {"param.set", {{"values", {{"second.core.gain", 2.0}}}}},
          {"change.undo", Json::object()},
          {"change.apply", {{"text", R"([ { "set": "second.core.gain", "value": 3.0 } ])"}}},
          {"service.call", {{"service", "signal.write"}, {"arguments", {0.5}}}},
          {"core.swap", {{"component", "first"}, {"core", "trial/throwing_job"}}},
          {"quarantine.release", {{"core", "trial/throwing_job"}}},
          {"core.swap", {{"component", "first"}, {"core", "trial/counting"}}},
          {"change.confirm", Json::object()},
          {"plugin.reload", {{"plugin", "trial"}}},
          {"port.disconnect", {{"port", "first.ports.output"}, {"probation", off}}},
          {"port.connect",
           {{"port", "first.ports.output"}, {"service", "signal.write"}, {"probation", off}}},
          {"architecture.apply", {{"text", other.dump()}, {"probation", off}}},
          {"config.rollback", {{"generation", 1}, {"state", "drop"}}},
          {"plugin.load", {{"plugin", "trial"}}},
          {"plugin.unload", {{"plugin", "trial"}}},
          {"lock.set", {{"lock", "all"}}},
          {"lock.set", {{"lock", "none"}}},
          {"log.set_level", {{"level", "debug"}, {"for", "1s"}}},
          {"stats.reset", Json::object()},
          {"trace.start", {{"seconds", 2}}},
          {"trace.stop", Json::object()},
          {"component.stop", {{"components", {"second"}}}},
          {"component.start", {{"components", {"second"}}}}};
}

/// How often each method was answered, and how often with a success.
struct Done {
  int asked = 0;
  int applied = 0;
  Json refusal = nullptr;  ///< the last
};

/// These are refused while their plugin is in use.
bool may_fail(const std::string& method) {
  return method == "plugin.load" || method == "plugin.unload";
}

/// Each succeeded at least once.
bool all_applied(const std::map<std::string, Done>& done, const std::vector<Question>& changes) {
  return std::ranges::all_of(changes, [&](const Question& change) {
    const auto its = done.find(change.method);
    return its != done.end() && (its->second.applied > 0 || may_fail(change.method));
  });
}

/// Until it is ordered to end, and until each of them succeeded: there is nothing to release or to
/// confirm when a core has not failed yet.
std::map<std::string, Done> change(RawClient& client, const std::atomic<bool>& end) {
  const auto changes = all_changes();
  const std::size_t most = 100 * changes.size();
  std::map<std::string, Done> done;
  for (std::size_t i = 0; !end || (i < most && !all_applied(done, changes)); ++i) {
    const auto& [method, params] = changes[i % changes.size()];
    const auto answer = client.ask(method, params);
    if (answer.is_null()) return done;
    ++done[method].asked;
    if (answer.contains("result")) {
      ++done[method].applied;
    } else {
      done[method].refusal = answer;
    }
  }
  return done;
}

/// All changes are made; those of one name succeed at times.
void expect_all(const std::map<std::string, Done>& done, TrialDaemon& daemon) {
  const Json methods = daemon.ask("command.list");
  for (const auto& row : methods["items"]) {
    const std::string method = row["name"];
    if (row["mutation"] != true) continue;
    EXPECT_TRUE(done.contains(method)) << "no read is beside " << method;
    if (!may_fail(method) && done.contains(method)) {
      EXPECT_GT(done.at(method).applied, 0) << method << done.at(method).refusal;
    }
  }
}

TEST(Beside, EveryReadIsServedWhileEverythingChanges) {
  constexpr int kTimes = 8;
  const TempDir place;
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", (place / "state").string()});
  const auto questions = all_reads(daemon);
  EXPECT_GT(questions.size(), 20U);
  RawClient changing = daemon.client();
  std::vector<RawClient> asking;
  for (int i = 0; i < 3; ++i) asking.push_back(daemon.client());
  std::atomic<bool> end{false};
  std::map<std::string, Done> done;
  std::vector<int> answers(asking.size());

  std::thread changer([&] { done = change(changing, end); });
  std::vector<std::thread> askers;
  for (std::size_t i = 0; i < asking.size(); ++i) {
    askers.emplace_back([&, i] { answers[i] = ask_all(asking[i], questions, kTimes); });
  }
  for (auto& asker : askers) asker.join();
  end = true;
  changer.join();

  constexpr int kJudged = 3;  // asked once
  const int often = static_cast<int>(questions.size()) - kJudged;
  EXPECT_THAT(answers, testing::Each(kTimes * often + kJudged));
  expect_all(done, daemon);
  ASSERT_TRUE(daemon.process().running()) << daemon.errors();
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
