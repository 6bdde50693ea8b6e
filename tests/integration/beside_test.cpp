// SPDX-License-Identifier: LGPL-3.0-or-later
// Reads beside changes: whatever a viewer asks for, no thread reads what another one destroys.
#include <atomic>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using Json = protocol::Json;

struct Question {
  std::string method;
  Json params;
};

/// Every method that changes nothing, with arguments that let it do its work.
std::vector<Question> all_reads(TrialDaemon& daemon) {
  const std::map<std::string, Json> arguments = {
      {"address", "first"},   {"addresses", {"signal.read", "first.core.count"}},
      {"component", "first"}, {"components", {"first"}},
      {"subscription", 1},    {"sub", 1},
      {"text", kTrial},       {"name", "none"},
      {"file", "none"},       {"generation", 1}};
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
      const bool judged = method == "config.check" || method == "architecture.diff";
      if (judged && i > 0) continue;  // each of them starts a process
      if (client.ask(method, params).is_null()) return answers;
      ++answers;
    }
  }
  return answers;
}

/// Swaps, sets, stops and starts until told to end; the changes that were applied.
int change(RawClient& client, const std::atomic<bool>& end) {
  const std::vector<Question> changes = {
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}, {"probation", "off"}}},
      {"param.set", {{"values", {{"second.core.gain", 2.0}}}, {"probation", "off"}}},
      {"core.swap", {{"component", "first"}, {"core", "trial/counting"}, {"probation", "off"}}},
      {"plugin.reload", {{"plugin", "trial"}}},
      {"component.stop", {{"components", {"second"}}}},
      {"component.start", {{"components", {"second"}}}}};
  int applied = 0;
  for (std::size_t i = 0; !end; ++i) {
    const auto& [method, params] = changes[i % changes.size()];
    if (client.ask(method, params).contains("result")) ++applied;
  }
  return applied;
}

TEST(Beside, EveryReadIsServedWhileEverythingChanges) {
  constexpr int kTimes = 8;
  TrialDaemon daemon;
  const auto questions = all_reads(daemon);
  EXPECT_GT(questions.size(), 20U);
  RawClient changing = daemon.client();
  std::vector<RawClient> asking;
  for (int i = 0; i < 3; ++i) asking.push_back(daemon.client());
  std::atomic<bool> end{false};
  int applied = 0;
  std::vector<int> answers(asking.size());

  std::thread changer([&] { applied = change(changing, end); });
  std::vector<std::thread> askers;
  for (std::size_t i = 0; i < asking.size(); ++i) {
    askers.emplace_back([&, i] { answers[i] = ask_all(asking[i], questions, kTimes); });
  }
  for (auto& asker : askers) asker.join();
  end = true;
  changer.join();

  const int often = static_cast<int>(questions.size()) - 2;
  EXPECT_THAT(answers, testing::Each(kTimes * often + 2));
  EXPECT_GT(applied, 10);
  ASSERT_TRUE(daemon.process().running()) << daemon.errors();
  EXPECT_EQ(daemon.component("first")["state"], "running");
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
