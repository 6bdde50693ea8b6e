// SPDX-License-Identifier: LGPL-3.0-or-later
// The value of a generation when some of several changes are undone.
#include "kept_daemon.h"

namespace mauve::test {
namespace {

/// The system of the trial with a third component.
std::string with_third() {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["components"]["third"] = architecture["components"]["second"];
  return architecture.dump();
}

Json set_until_confirmed(const std::string& component, const std::string& within = "600s") {
  return {{"values", {{component + ".core.gain", 2.0}}}, {"confirm_within", within}};
}

Json final_set() { return {{"values", {{"third.core.gain", 5.0}}}, {"probation", "off"}}; }

Json swap_in_place(const std::string& component, const Json& more) {
  Json params = {{"component", component}, {"core", "trial/other"}, {"in_place", true}};
  params.update(more);
  return params;
}

TEST_F(Generations, OfAFinalChangeAreConfirmedInWhateverOrderTheOthersAreUndone) {
  TrialDaemon daemon(with_third(), options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  ASSERT_EQ(daemon.ask("param.set", set_until_confirmed("first"))["generation"], 2);
  ASSERT_EQ(daemon.ask("param.set", set_until_confirmed("second"))["generation"], 3);
  ASSERT_EQ(daemon.ask("param.set", final_set())["generation"], 4);

  ASSERT_EQ(daemon.ask("change.undo", {{"generation", 2}})["generation"], 5);
  ASSERT_TRUE(eventually([&] { return newest(daemon)["generation"] == 5; }));
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed") << "it holds the change 3";
  ASSERT_EQ(daemon.ask("change.undo", {{"generation", 3}})["generation"], 6);

  ASSERT_TRUE(eventually([&] { return newest(daemon)["mark"] == "confirmed"; }))
      << daemon.ask("config.history");
  EXPECT_EQ(newest(daemon)["generation"], 6);
  crash(daemon);
  daemon.start();
  EXPECT_EQ(daemon.value("third.core.gain"), 5.0) << daemon.errors();
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
  EXPECT_EQ(daemon.value("second.core.gain"), 1.0);
}

TEST_F(Generations, AreConfirmedWhenTheTimesToConfirmOthersRunOutOldestFirst) {
  TrialDaemon daemon(with_third(), options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  ASSERT_EQ(daemon.ask("param.set", set_until_confirmed("first", "8s"))["generation"], 2);
  ASSERT_EQ(daemon.ask("param.set", set_until_confirmed("second", "9s"))["generation"], 3);
  ASSERT_EQ(daemon.ask("param.set", final_set())["generation"], 4);

  EXPECT_TRUE(eventually([&] {
    const auto last = newest(daemon);
    return last["generation"] == 6 && last["mark"] == "confirmed";
  })) << daemon.ask("config.history");
}

/// The new code without a probation proves itself in its time, also when another change is undone.
TEST_F(Generations, WithNewCodeAreNotConfirmedByTheUndoOfAnotherChange) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  ASSERT_EQ(daemon.ask("param.set", set_until_confirmed("first"))["generation"], 2);
  const auto swap = swap_in_place("second", {{"probation", "off"}});
  ASSERT_EQ(daemon.ask("core.swap", swap)["generation"], 3);

  ASSERT_EQ(daemon.ask("change.undo", {{"generation", 2}})["generation"], 4);
  const auto looked = daemon.ask("status.get")["uptime_s"].get<double>() + 0.2;
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["uptime_s"] > looked; }));

  EXPECT_EQ(newest(daemon)["generation"], 4);
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");
  EXPECT_TRUE(
      eventually([&] { return newest(daemon)["mark"] == "confirmed"; }, std::chrono::seconds(60)));
  EXPECT_EQ(newest(daemon)["generation"], 4);
}

TEST_F(Generations, OfTwoSwapsInPlaceAreNotConfirmedByTheEndOfOne) {
  TrialDaemon daemon(with_third(), options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  const Json until_confirmed = {{"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("core.swap", swap_in_place("first", until_confirmed))["generation"], 2);
  ASSERT_EQ(daemon.ask("core.swap", swap_in_place("second", until_confirmed))["generation"], 3);
  ASSERT_EQ(daemon.ask("core.swap", swap_in_place("third", {{"probation", "20"}}))["generation"],
            4);

  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["probations"].size() == 2U; }));
  ASSERT_EQ(daemon.ask("change.undo", {{"generation", 2}})["state"], "applied");
  const auto looked = daemon.ask("status.get")["uptime_s"].get<double>() + 0.2;
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["uptime_s"] > looked; }));
  const auto history = daemon.ask("config.history");
  ASSERT_TRUE(history.contains("items") && !history["items"].empty()) << history;
  for (const auto& one : history["items"]) {
    EXPECT_EQ(one["mark"] == "confirmed", one["generation"] == 1) << one;
  }

  ASSERT_EQ(daemon.ask("change.undo", {{"generation", 3}})["state"], "applied");
  EXPECT_TRUE(eventually([&] { return newest(daemon)["mark"] == "confirmed"; }))
      << daemon.ask("config.history");
}

}  // namespace
}  // namespace mauve::test
