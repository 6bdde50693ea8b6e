// SPDX-License-Identifier: LGPL-3.0-or-later
// Every method is called on a running mauved, and its answer holds what its row names: TrialDaemon
// compares the answers.
#include <algorithm>
#include <filesystem>
#include <set>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

/// With a rule and a transaction, so that their records are answered too.
std::string with_a_rule() {
  std::string text(kTrial);
  const std::string resources = "\"resources\"";
  return text.insert(text.find(resources), R"("rules": [
      { "name": "loud", "when": "second.core.input > 1e9",
        "do": [{ "set": "first.core.gain", "value": 1.0 }] }],
    )");
}

class AnswersOf : public testing::Test {
 protected:
  AnswersOf() {
    std::filesystem::copy_file(MAUVE_PLUGIN_DIR "/demo.so", daemon_.plugins() / "demo.so");
  }

  /// The answer of a method that must succeed.
  Json ask(const std::string& method, Json params = Json::object()) {
    const auto answer = client_.ask(method, std::move(params));
    EXPECT_TRUE(answer.contains("result")) << method << answer;
    called_.insert(method);
    return answer.value("result", Json());
  }
  Json ask_each(const std::string& method, const std::string& name, const Json& values) {
    Json last;
    for (const auto& value : values) last = ask(method, {{name, value}});
    return last;
  }

  /// Also each method that a later version adds, if it only reads and needs no argument.
  void look() {
    for (const auto& method : protocol::methods()) {
      const auto is_needed = [](const auto& param) { return !param.optional; };
      const bool reads = !method.mutation() && method.effect != protocol::Effect::records;
      const bool traces = method.name.starts_with("trace.");  // there is nothing to read yet
      if (reads && !traces && std::ranges::none_of(method.params, is_needed)) {
        ask(std::string(method.name));
      }
    }
    ask_each("core.list", "for", {"first"});
    ask_each("plugin.list", "for", {"first"});
    ask_each("port.list", "component", {"first", "signal"});
    ask_each("stats.get", "address", {"first"});
    ask_each("component.why", "component", {"first", "second"});
    ask_each("condition.get", "condition", {"first.core.count > 1"});
    const Json addresses = {
        "first.core.gain", "first.core.count", "first.ports.output", "second.ports.input",
        "signal.read",     "first.missed",     "first.task.budget",  "second.ports.input.status"};
    ask_each("param.get", "address", addresses);
    ask_each("object.get", "address",
             {"first", "signal", "first.core", "signal.core", "first.core.gain", "first.core.count",
              "first.ports.output", "second.ports.input", "signal.read", "signal.write"});
  }
  void set_and_watch() {
    const Json gain = {{"values", {{"first.core.gain", 0.7}}}};
    ask("param.set", gain);
    ask("param.set", {{"values", {{"first.core.gain", 0.6}}}, {"dry_run", true}});
    ask("change.apply", {{"text", R"([{ "set": "second.core.gain", "value": 3.0 }])"}});
    ask("service.call", {{"service", "count.write"}, {"arguments", {5}}});
    const auto sub = ask("watch.subscribe", {{"addresses", {"signal.read"}}})["sub"];
    ask("watch.unsubscribe", {{"sub", sub}});
    ask_each("lock.set", "lock", {"params", "none"});
    ask("log.set_level", {{"level", "debug"}, {"component", "first"}, {"for", "1min"}});
    ask("stats.reset");
    ask("log.tail", {{"n", 50}, {"follow", true}});
  }
  void change() {
    ask("component.stop", {{"components", {"first"}}});
    ask("component.stop", {{"components", {"first"}}, {"dry_run", true}});
    ask("component.start", {{"all", true}});
    ask("port.connect", {{"port", "second.ports.input"},
                         {"service", "signal.read"},
                         {"replace", true},
                         {"max_age", "50ms"}});
    ask("port.disconnect", {{"port", "second.ports.input"}});
    ask("change.undo", {{"dry_run", true}});
    ask("change.undo");
    ask("core.swap", {{"component", "first"}, {"core", "trial/counting"}, {"dry_run", true}});
    ask("core.swap", {{"component", "first"}, {"core", "trial/other"}, {"defaults", true}});
    ask("change.confirm");
    ask("status.get");
    ask("plugin.reload", {{"plugin", "trial"}, {"dry_run", true}});
    ask("plugin.reload", {{"plugin", "trial"}});
    ask("change.confirm");
    ask("plugin.load", {{"plugin", "demo"}, {"dry_run", true}});
    ask("plugin.load", {{"plugin", "demo"}});
    ask("plugin.unload", {{"plugin", "demo"}});
  }
  /// A core that fails is rolled back; the records of failures and quarantine are answered then.
  void fail() {
    ask("core.swap", {{"component", "first"}, {"core", "trial/throwing_job"}});
    EXPECT_TRUE(eventually([&] { return !ask("quarantine.list")["cores"].empty(); }));
    const auto why = ask("component.why", {{"component", "first"}});
    EXPECT_TRUE(why["failure"].is_object()) << why;
    ask("status.get");
    ask("quarantine.release", {{"core", "trial/throwing_job"}});
  }
  void use_files() {
    const std::string text = ask("config.get")["architecture"].dump();
    ask_each("config.check", "text", {text, "{", R"({"schema": "mauve/architecture/1"})"});
    ask("architecture.diff", {{"text", with_a_rule()}});
    ask("architecture.apply", {{"text", with_a_rule()}, {"dry_run", true}});
    ask("architecture.apply", {{"text", with_a_rule()}});
    const auto kept = ask("config.history", {{"n", 5}});
    ASSERT_GE(kept["items"].size(), 2U);
    EXPECT_TRUE(kept["state_dir"].is_string());
    const auto& newest = kept["items"][0]["generation"];
    ask("config.compare", {{"from", kept["items"][1]["generation"]}, {"to", newest}});
    ask("config.rollback", {{"generation", kept["items"][1]["generation"]}, {"dry_run", true}});
    ask("config.rollback", {{"generation", kept["items"][1]["generation"]}});
  }
  void trace() {
    ask("trace.start", {{"detail", true}, {"seconds", 2}});
    ask("trace.read", {{"count", 10}});
    ask("trace.stop");
    ask("trace.status");
    ask("trace.list");
  }
  TempDir state_;
  TrialDaemon daemon_{with_a_rule(), {"--realtime", "off", "--state-dir", state_.path().string()}};
  RawClient client_ = daemon_.client();
  std::set<std::string> called_;
};

TEST_F(AnswersOf, EveryMethodHoldOnlyFieldsOfItsRow) {
  look();
  set_and_watch();
  change();
  fail();
  use_files();
  trace();

  for (const auto& method : protocol::methods()) {
    EXPECT_TRUE(called_.contains(std::string(method.name))) << method.name << " was not called";
  }
}

TEST_F(AnswersOf, RpcDiscoverDescribeEveryMethod) {
  const auto document = ask("rpc.discover");

  EXPECT_EQ(document["openrpc"], "1.2.6");
  EXPECT_EQ(document, Json::parse(daemon_.ctl({"--json", "protocol"}).out, nullptr, false));
  std::set<std::string> names;
  for (const auto& method : document["methods"]) names.insert(method["name"]);
  EXPECT_EQ(names.size(), protocol::methods().size());
}

TEST(AnswerCheck, FindsAFieldThatNoRowNames) {
  const auto& ping = *protocol::find_method("ping");
  EXPECT_THAT(misfits(ping, {{"pong", true}}), testing::IsEmpty());
  EXPECT_THAT(misfits(ping, {{"pong", true}, {"extra", 1}}),
              testing::ElementsAre("ping.extra is not in the row: 1"));
  EXPECT_THAT(misfits(ping, Json::object()), testing::ElementsAre("ping.pong is missing"));
  EXPECT_THAT(misfits(ping, {{"pong", "yes"}}),
              testing::ElementsAre("ping.pong is no boolean: \"yes\""));
  const auto& list = *protocol::find_method("quarantine.list");
  const Json inside = {{"cores", {{{"core", "a/b"}, {"build_id", "1"}, {"reason", 2}}}}};
  EXPECT_THAT(misfits(list, inside),
              testing::ElementsAre("quarantine.list.cores[].reason is no text: 2"));
}

}  // namespace
}  // namespace mauve::test
