// SPDX-License-Identifier: LGPL-3.0-or-later
// The model is operated from a shell: tasks, connections, several steps at once, services.
#include "rt/thread/run_guarded.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// With a second place to write to, a resource that takes values with its own code, and one that
/// hangs when it is given 4.
std::string wide() {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["resources"]["spare"] = {{"type", "shared_data"}, {"data", "double"}};
  architecture["resources"]["tally"] = {{"type", "trial/tally"}};
  architecture["resources"]["meter"] = {{"type", "trial/meter"}};
  return architecture.dump();
}

/// A mauved that answers already.
class Operated : public TrialDaemon {
 public:
  explicit Operated(const std::string& architecture = kTrial) : TrialDaemon(architecture) {
    static_cast<void>(client());
  }
};

/// Of the last mauvectl.
std::string errors_of(TrialDaemon& daemon) {
  return TempDir::read((daemon.place() / "client.txt").string());
}

Json generation(TrialDaemon& daemon) { return daemon.ask("status.get")["generation"]; }

TEST(SetOfATask, ChangesTheAttributeInOneChangeWithProperties) {
  Operated daemon;

  const auto said =
      daemon.ctl({"set", "first.task.budget=900us", "first.task.priority=33", "first.core.gain=2"});

  EXPECT_EQ(said.exit, 0) << errors_of(daemon);
  EXPECT_EQ(daemon.value("first.task.budget"), "900us");
  EXPECT_EQ(daemon.value("first.task.priority"), 33);
  EXPECT_EQ(daemon.value("first.core.gain"), 2.0);
  EXPECT_EQ(daemon.component("first")["priority"], 33);
}

TEST(SetOfATask, TakesAnAttributeBackWithNull) {
  Operated daemon;
  ASSERT_EQ(daemon.ctl({"set", "first.task.budget=900us"}).exit, 0);

  EXPECT_EQ(daemon.ctl({"set", "first.task.budget=null"}).exit, 0);

  EXPECT_EQ(daemon.value("first.task.budget"), nullptr);
}

TEST(SetOfATask, IsRefusedByTheRulesOfTheFile) {
  Operated daemon;
  const auto before = generation(daemon);

  const auto unknown = daemon.ask("param.set", {{"values", {{"first.task.budgte", "1ms"}}}});
  const auto bare = daemon.ask("param.set", {{"values", {{"first.task.budget", 2}}}});
  const auto high = daemon.ask("param.set", {{"values", {{"first.task.priority", 1000}}}});
  const auto resource = daemon.ask("param.set", {{"values", {{"signal.task.priority", 10}}}});

  EXPECT_EQ(unknown["data"]["hint"], "did you mean first.task.budget?") << unknown;
  EXPECT_EQ(bare["data"]["where"], "first.task.budget") << bare;
  EXPECT_EQ(high["data"]["where"], "first.task.priority") << high;
  EXPECT_EQ(resource["data"]["where"], "signal") << resource;
  EXPECT_EQ(generation(daemon), before);
}

TEST(SetOfAStructure, SaysWhichFieldsItKeptAndNamesPropertyAndFieldsWhenItIsRefused) {
  Operated daemon(wide());

  const auto partly = daemon.ctl({"set", "meter.core.mark={\"spare\":3}"});
  const auto wrong = daemon.ask("param.set", {{"values", {{"meter.core.mark", {{"z", 1}}}}}});
  const auto nested =
      daemon.ask("param.set", {{"values", {{"meter.core.mark", {{"count", "x"}}}}}});

  EXPECT_EQ(partly.exit, 0) << errors_of(daemon);
  EXPECT_THAT(partly.out, HasSubstr("meter.core.mark.count keeps 0"));
  EXPECT_EQ(wrong["data"]["where"], "meter.core.mark.z") << wrong;
  EXPECT_THAT(wrong["data"]["hint"].get<std::string>(), HasSubstr("has the fields spare, count"));
  EXPECT_EQ(nested["data"]["where"], "meter.core.mark.count") << nested;
}

TEST(SetOfAStructure, IsRefusedWhenAnItemOfAnArrayLeavesOutAField) {
  Operated daemon(wide());
  const auto whole = daemon.ctl({"set", R"(meter.core.marks=[{"spare":1,"count":2}])"});
  ASSERT_EQ(whole.exit, 0) << errors_of(daemon);
  const auto items = Json::array({{{"spare", 3}}, {{"spare", 4}, {"count", 5}}});
  const auto steps = Json::array({{{"set", "meter.core.marks"}, {"value", items}}});

  const auto error = daemon.ask("param.set", {{"values", {{"meter.core.marks", items}}}});
  const auto step = daemon.ask("change.apply", {{"text", steps.dump()}});

  EXPECT_EQ(error["data"]["id"], "fields_missing") << error;
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("leaves out the field [0].count"));
  EXPECT_THAT(step.dump(), HasSubstr("leaves out the field [0].count"));
  EXPECT_EQ(daemon.value("meter.core.marks"), Json::array({{{"spare", 1.0}, {"count", 2}}}));
}

TEST(ConnectReplace, ExchangesTheConnectionInOneChange) {
  Operated daemon(wide());
  const auto before = generation(daemon).get<int>();
  const auto refused = daemon.ctl({"connect", "first.ports.output", "spare.write"});
  ASSERT_EQ(refused.exit, 1);
  EXPECT_THAT(errors_of(daemon), HasSubstr("is connected to signal.write already"));
  EXPECT_THAT(errors_of(daemon), HasSubstr("--replace"));

  const auto same = daemon.ctl({"connect", "first.ports.output", "signal.write"});
  EXPECT_EQ(same.exit, 0) << errors_of(daemon);
  EXPECT_THAT(same.out, HasSubstr("nothing to change"));
  EXPECT_EQ(generation(daemon), before);
  EXPECT_EQ(daemon.ctl({"connect", "first.ports.output", "signal.read"}).exit, 1);
  EXPECT_THAT(errors_of(daemon), HasSubstr("is a read double service"));

  const auto said = daemon.ctl({"connect", "--replace", "first.ports.output", "spare.write"});

  EXPECT_EQ(said.exit, 0) << errors_of(daemon);
  EXPECT_EQ(generation(daemon), before + 1);
  EXPECT_TRUE(eventually([&] { return daemon.value("spare.read").is_number(); }));
}

TEST(GetOfAWritePort, ShowsWhereItLeadsAndTheLastValue) {
  Operated daemon;
  ASSERT_TRUE(eventually([&] { return daemon.value("signal.read").is_number(); }));

  const auto port = daemon.ask("param.get", {{"address", "first.ports.output"}});

  EXPECT_EQ(port["service"], "signal.write") << port;
  EXPECT_EQ(port["kind"], "write");
  EXPECT_TRUE(port["value"].is_number()) << port;
  EXPECT_THAT(daemon.ctl({"get", "first.ports.output"}).out, HasSubstr("leads to signal.write"));
}

TEST(ChangeOfSteps, TakesEffectAtOneInstant) {
  Operated daemon(wide());
  const auto before = generation(daemon).get<int>();
  const auto file = daemon.place().write("steps.json", R"([
    { "connect": "first.ports.output", "to": "spare.write" },
    { "set": "first.core.gain", "value": 3.0 },
    { "stop": "second" } ])");

  const auto said = daemon.ctl({"change", "-f", file.string()});

  EXPECT_EQ(said.exit, 0) << errors_of(daemon);
  EXPECT_THAT(said.out, HasSubstr("~ first.core.gain: 1 -> 3"));
  EXPECT_EQ(generation(daemon), before + 1);
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  EXPECT_THAT(daemon.ctl({"connect", "--replace", "first.ports.output", "spare.write"}).out,
              HasSubstr("nothing to change"));
}

TEST(ChangeOfSteps, IsRefusedAsAWholeWithThePlaceOfEachError) {
  Operated daemon;
  const auto file = daemon.place().write("steps.json", R"([
    { "set": "first.core.gain", "value": 3.0 },
    { "set": "first.core.gian", "value": 3.0 },
    { "swap": "second", "core": "trial/nothing" } ])");

  const auto said = daemon.ctl({"change", "-f", file.string()});

  EXPECT_EQ(said.exit, 1);
  EXPECT_THAT(errors_of(daemon), HasSubstr("steps.json:3:"));
  EXPECT_THAT(errors_of(daemon), HasSubstr("steps.json:4:"));
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
}

TEST(ChangeOfSteps, SetsNothingWhileParamsAreLocked) {
  Operated daemon;
  ASSERT_EQ(daemon.ctl({"lock", "params"}).exit, 0);

  const auto refused =
      daemon.ask("change.apply", {{"text", R"([ { "set": "first.core.gain", "value": 3.0 } ])"}});

  EXPECT_EQ(refused["data"]["name"], "conflict") << refused;
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
}

TEST(DryRun, ShowsTheLinesOfEveryChangeAndChangesNothing) {
  Operated daemon(wide());
  ASSERT_EQ(daemon.ctl({"stop", "second"}).exit, 0);
  const auto before = generation(daemon);
  const std::vector<std::pair<std::vector<std::string>, std::string>> all{
      {{"set", "first.core.gain=2"}, "first.core.gain"},
      {{"set", "first.task.budget=900us"}, "first.task.budget"},
      {{"connect", "second.ports.output", "spare.write"}, "second.ports.output"},
      {{"disconnect", "first.ports.output"}, "first.ports.output"},
      {{"swap-core", "first", "trial/other", "--state", "drop"}, "trial/other"},
      {{"start", "second"}, "second.start"},
      {{"stop", "first"}, "first.start: true -> false"},
      {{"reload", "trial"}, "plugin trial"}};
  for (auto [words, line] : all) {
    words.emplace_back("--dry-run");

    const auto said = daemon.ctl(words);

    EXPECT_EQ(said.exit, 0) << errors_of(daemon);
    EXPECT_THAT(said.out, HasSubstr(line)) << words[0];
    EXPECT_THAT(said.out, HasSubstr("nothing was changed"));
  }
  EXPECT_EQ(generation(daemon), before);
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(WriteFromTheShell, ReachesStoredDataAndNamesTheOtherWriters) {
  Operated daemon(wide());

  const auto said = daemon.ctl({"write", "spare.write", "0.25"});
  const auto shared = daemon.ctl({"write", "signal.write", "0.25"});

  EXPECT_EQ(said.exit, 0) << errors_of(daemon);
  EXPECT_EQ(daemon.value("spare.read"), 0.25);
  EXPECT_EQ(shared.exit, 0) << errors_of(daemon);
  EXPECT_THAT(shared.out, HasSubstr("first.ports.output writes to it too"));
}

TEST(WriteFromTheShell, RunsCodeOfAResourceThatHangsForABoundedTimeOnly) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  Operated daemon(wide());

  const auto error = daemon.ask("service.call", {{"service", "meter.write"}, {"arguments", {4.0}}});

  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("meter is poisoned")) << error;
  EXPECT_EQ(daemon.ask("status.get")["poisoned"], Json({"meter"}));
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(WriteFromTheShell, IsRefusedWithTheTypesOfTheService) {
  Operated daemon(wide());

  const auto kind = daemon.ask("service.call", {{"service", "spare.write"}, {"arguments", {"x"}}});
  const auto count = daemon.ask("service.call", {{"service", "spare.write"}});
  const auto reads = daemon.ask("service.call", {{"service", "spare.read"}});

  EXPECT_EQ(kind["data"]["where"], "spare.write") << kind;
  EXPECT_THAT(count["message"].get<std::string>(), HasSubstr("takes 1 argument, got 0"));
  EXPECT_EQ(reads["data"]["hint"], "mauvectl get spare.read reads it");
}

TEST(WriteFromTheShell, IsRefusedWithTheFieldsThatTheValueLeavesOut) {
  Operated daemon(wide());
  ASSERT_EQ(daemon.ctl({"write", "meter.stamp", R"({"spare":1,"count":7})"}).exit, 0);

  const auto said = daemon.ctl({"write", "meter.stamp", R"({"spare":2})"});

  EXPECT_EQ(said.exit, 1);
  EXPECT_THAT(errors_of(daemon), HasSubstr("leaves out the field count of trial_memory/2"));
  EXPECT_THAT(errors_of(daemon), HasSubstr(R"(a whole value: '{"spare":2,"count":0}')"));
  EXPECT_EQ(daemon.value("meter.core.stamped"), 7) << "nothing was written";
}

TEST(WaitForACondition, EndsWhenItHoldsAndWithExitCodeThreeWhenTheTimePasses) {
  Operated daemon(wide());
  ASSERT_EQ(daemon.ctl({"write", "spare.write", "0.25"}).exit, 0);

  EXPECT_EQ(daemon.ctl({"wait", "--for", "spare.read > 0.2"}).exit, 0);
  const auto late = daemon.ctl({"wait", "--for", "spare.read > 0.3", "--timeout", "3s"});
  EXPECT_EQ(late.exit, 3);
  EXPECT_THAT(late.out, HasSubstr("spare.read is 0.25"));
  EXPECT_EQ(daemon.ctl({"wait", "--for", "spare.raed > 0.3"}).exit, 4);
  EXPECT_EQ(daemon.ctl({"wait", "--for", "spare.read >"}).exit, 1);
}

TEST(WaitForACondition, IsRefusedAsInARuleWhereItCanNeverHold) {
  Operated daemon(wide());
  const auto refusal = [&](const std::string& condition) {
    const auto said = daemon.ctl({"wait", "--for", condition, "--timeout", "1min"});
    EXPECT_EQ(said.exit, 1) << condition;
    return errors_of(daemon);
  };

  EXPECT_THAT(refusal("first.fsm.period > 3"),
              HasSubstr("write a number and a unit, such as 20ms"));
  EXPECT_THAT(refusal("first.core.gain < 500ms"),
              HasSubstr("is a number, but is compared with a duration"));
  EXPECT_THAT(refusal("first.core > 3"), HasSubstr("is a word, but is compared with a number"));
  EXPECT_THAT(refusal("first.core < trial/counter"), HasSubstr("use == or !="));
  EXPECT_THAT(refusal("first.missed > 1000 or first.state == runing"),
              HasSubstr("did you mean \"running\""));
  EXPECT_EQ(daemon.ctl({"wait", "--for", "first.fsm.period < 3s"}).exit, 0);
}

}  // namespace
}  // namespace mauve::test
