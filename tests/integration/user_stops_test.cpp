// SPDX-License-Identifier: LGPL-3.0-or-later
// A stop by a user, answered, stands against everything that comes after it but a start by a user.
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "user_stop.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST_F(UserStop, OfWhatAChangeHasStoppedAlreadyStandsAgainstItsUndo) {
  begin();
  for (const Json& which : {kSecondOnly, kEach}) {
    const auto changed =
        daemon->ask("change.apply",
                    steps({{{"stop", "second"}}, {{"set", "first.core.gain"}, {"value", 3.0}}}));
    ASSERT_EQ(changed["state"], "applied") << changed;
    const auto stopped = daemon->ask("component.stop", which);
    EXPECT_EQ(stopped["saved"], true) << stopped;

    ASSERT_EQ(daemon->ask("change.undo")["state"], "applied");

    EXPECT_EQ(daemon->value("first.core.gain"), 1.0);
    EXPECT_TRUE(stands());
    ASSERT_EQ(daemon->ask("component.start", kEach)["state"], "applied");
    EXPECT_EQ(state_of("second"), "running");
  }
}

TEST_F(UserStop, IsNamedWithItsUserWhileItStands) {
  begin();
  const auto by = [this](const std::string& name) {
    EXPECT_EQ(daemon->ask("component.why", {{"component", name}})["stopped_by"],
              daemon->component(name).value("stopped_by", Json()));
    return daemon->component(name).value("stopped_by", std::string());
  };
  const auto this_user = testing::StartsWith("uid " + std::to_string(getuid()) + " stopped it at ");
  EXPECT_EQ(by("second"), "");

  daemon->ask("component.stop", kSecondOnly);
  EXPECT_THAT(by("second"), this_user);
  EXPECT_EQ(by("first"), "");
  daemon->ask("component.stop", kEach);
  EXPECT_THAT(by("first"), this_user);
  daemon->ask("component.start", kEach);
  EXPECT_EQ(by("first") + by("second"), "");

  ASSERT_EQ(daemon->ask("change.apply", steps({{{"stop", "second"}}}))["state"], "applied");
  EXPECT_THAT(by("second"), this_user) << "a stop in steps is a stop";
}

TEST_F(UserStop, StandsWhenNobodyConfirmsTheChangeThatStoppedItBefore) {
  begin();
  const auto changed = daemon->ask(
      "change.apply",
      steps({{{"stop", "second"}}, {{"set", "first.core.gain"}, {"value", 3.0}}}, "300ms"));
  ASSERT_EQ(changed["state"], "applied") << changed;
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);

  ASSERT_TRUE(daemon->becomes("first.core.gain", 1.0));

  EXPECT_TRUE(stands());
}

TEST_F(UserStop, OutlivesACrashAtAnyMomentAfterItsAnswer) {
  begin();
  for (const int delay : {0, 1, 5, 20}) {
    const bool all = delay == 1 || delay == 20;
    const auto stopped = daemon->ask("component.stop", all ? kEach : kSecondOnly);
    EXPECT_EQ(stopped["saved"], true) << stopped;
    std::this_thread::sleep_for(std::chrono::milliseconds(delay));
    crash(*daemon);
    daemon->start();

    EXPECT_EQ(state_of("second"), "stopped") << daemon->errors();
    EXPECT_EQ(state_of("first"), all ? "stopped" : "running");
    EXPECT_EQ(daemon->ask("component.start", kEach)["saved"], true);
    EXPECT_EQ(state_of("second"), "running");
  }
  ASSERT_EQ(daemon->ask("change.confirm")["saved"], true) << "older generations have it stopped";
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("second"), "running") << "the start was saved too";
}

TEST_F(UserStop, OfAllOutlivesACrashForAComponentThatAnUnconfirmedChangeRemoved) {
  begin();
  auto without = Json::parse(std::string(kTrial));
  without["components"].erase("second");
  const auto removed =
      daemon->ask("architecture.apply", {{"text", without.dump()}, {"confirm_within", "600s"}});
  ASSERT_EQ(removed["state"], "applied") << removed;
  ASSERT_EQ(daemon->ask("component.stop", kEach)["saved"], true);

  crash(*daemon);
  daemon->start();

  EXPECT_EQ(state_of("second"), "stopped") << daemon->errors();
  EXPECT_EQ(state_of("first"), "stopped");
  EXPECT_TRUE(daemon->says("second: stays stopped, since uid ")) << daemon->errors();
}

TEST_F(UserStop, OfAllStandsAgainstAComponentThatJoinsLater) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kEach)["saved"], true);
  ASSERT_EQ(daemon->ask("component.start", {{"components", {"first", "second"}}})["saved"], true);
  auto more = Json::parse(std::string(kTrial));
  more["components"]["guest"] = {{"type", "trial/unit"}};

  const auto joined = apply_file(more.dump());

  EXPECT_EQ(joined["state"], "applied") << joined;
  EXPECT_THAT(notes_in(joined), HasSubstr("guest stays stopped: uid "));
  EXPECT_TRUE(stands("guest"));
  EXPECT_EQ(state_of("first"), "running");
  EXPECT_EQ(daemon->ask("component.start", {{"components", {"guest"}}})["saved"], true);
  EXPECT_EQ(state_of("guest"), "running");
}

TEST_F(UserStop, EndsForThoseThatJoinLaterWithAStartOfAll) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kEach)["saved"], true);
  ASSERT_EQ(daemon->ask("component.start", {{"components", {"first", "second"}}})["saved"], true);
  ASSERT_EQ(daemon->ask("component.start", kEach)["state"], "unchanged") << "they run already";
  auto more = Json::parse(std::string(kTrial));
  more["components"]["guest"] = {{"type", "trial/unit"}};

  ASSERT_EQ(apply_file(more.dump())["state"], "applied");

  EXPECT_EQ(state_of("guest"), "running");
}

TEST_F(UserStop, IsAnsweredAsNotSavedWhenTheDiskIsFullAndCarriedOutAllTheSame) {
  begin();
  rlimit now{};
  ASSERT_EQ(prlimit(daemon->process().id(), RLIMIT_FSIZE, nullptr, &now), 0);
  const rlimit none{0, now.rlim_max};
  ASSERT_EQ(prlimit(daemon->process().id(), RLIMIT_FSIZE, &none, nullptr), 0);

  const auto stopped = daemon->ask("component.stop", kSecondOnly);

  EXPECT_EQ(stopped["state"], "applied") << stopped;
  EXPECT_EQ(stopped["saved"], false);
  EXPECT_THAT(notes_in(stopped), HasSubstr("it is not saved"));
  EXPECT_TRUE(stands());
  EXPECT_TRUE(was_logged(*daemon, "stops_not_saved"));
  ASSERT_EQ(prlimit(daemon->process().id(), RLIMIT_FSIZE, &now, nullptr), 0);
  const auto again = daemon->ask("component.stop", kSecondOnly);
  EXPECT_EQ(again["saved"], true) << again;
  EXPECT_EQ(again["state"], "unchanged");
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("second"), "stopped");
}

TEST_F(UserStop, ThatCannotBeReadAfterACrashKeepsEverythingStopped) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  crash(*daemon);
  static_cast<void>(place_.write("state/stops.json", R"({"components": {"sec)"));
  daemon->start();

  EXPECT_EQ(state_of("first"), "stopped") << daemon->errors();
  EXPECT_EQ(state_of("second"), "stopped");
  EXPECT_TRUE(was_logged(*daemon, "stops_lost"));
  EXPECT_THAT(
      daemon->component("first").value("stopped_by", ""),
      testing::MatchesRegex("mauved stopped it at .*: the list of stops could not be read"));
  EXPECT_EQ(daemon->ask("component.start", kEach)["saved"], true);
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("first"), "running");
}

TEST_F(UserStop, StandsAgainstAFileThatHasItRunning) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  auto faster = Json::parse(std::string(kTrial));
  faster["components"]["first"]["properties"]["core.gain"] = 2.0;
  const std::string note = "second stays stopped: uid ";

  const auto plan = daemon->ask("architecture.diff", {{"text", kTrial}});
  EXPECT_EQ(plan["lines"], Json::array()) << plan;
  EXPECT_THAT(notes_in(plan), HasSubstr(note));
  const auto tried = apply_file(faster.dump(), true);
  EXPECT_EQ(tried["lines"].size(), 1U) << tried;
  EXPECT_THAT(notes_in(tried), HasSubstr(note));
  const auto same = apply_file(kTrial);
  EXPECT_EQ(same["state"], "unchanged") << same;
  EXPECT_THAT(notes_in(same), HasSubstr(note));
  const auto applied = apply_file(faster.dump());

  EXPECT_EQ(applied["state"], "applied") << applied;
  EXPECT_THAT(notes_in(applied), HasSubstr(note));
  EXPECT_EQ(daemon->value("first.core.gain"), 2.0);
  EXPECT_TRUE(stands());
}

TEST_F(UserStop, StandsAgainstARollbackToAGenerationThatHasItRunning) {
  begin();
  ASSERT_EQ(daemon->ask("param.set", gain(2.0))["saved"], true);
  const auto running = newest(*daemon)["generation"];
  ASSERT_EQ(daemon->ask("param.set", gain(3.0))["saved"], true);
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);

  const auto back = daemon->ask("config.rollback", {{"generation", running}});

  EXPECT_EQ(back["state"], "applied") << back;
  EXPECT_THAT(notes_in(back), HasSubstr("second stays stopped: uid "));
  EXPECT_EQ(daemon->value("first.core.gain"), 2.0);
  EXPECT_TRUE(stands());
}

TEST_F(UserStop, EndsWithStepsOfAUserThatStartIt) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  const auto started = daemon->ask("change.apply", steps({{{"start", "second"}}}));
  EXPECT_EQ(started["state"], "applied") << started;
  EXPECT_EQ(state_of("second"), "running");
  crash(*daemon);
  daemon->start();
  EXPECT_EQ(state_of("second"), "running");
}

TEST_F(UserStop, StandsAgainWhenTheStartThatEndedItIsUndone) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  ASSERT_NO_FATAL_FAILURE(start_on_probation());

  ASSERT_EQ(daemon->ask("change.undo")["state"], "applied");

  EXPECT_TRUE(stands());
  EXPECT_TRUE(daemon->component("second").contains("stopped_by"));
  end_and_start(*daemon);
  EXPECT_TRUE(stands()) << "also after an end in order and a start";
  EXPECT_THAT(notes_in(apply_file(kTrial)), HasSubstr("second stays stopped"));
  EXPECT_TRUE(stands()) << "no file starts it";
}

TEST_F(UserStop, StandsAgainWhenMauvedIsKilledBeforeTheStartThatEndedItIsConfirmed) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  ASSERT_NO_FATAL_FAILURE(start_on_probation());

  crash(*daemon);
  daemon->start();

  EXPECT_TRUE(stands());
  EXPECT_THAT(notes_in(apply_file(kTrial)), HasSubstr("second stays stopped"));
  EXPECT_TRUE(stands()) << "no file starts it";
}

TEST_F(UserStop, IsOverWhenTheStartThatEndedItIsConfirmed) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  ASSERT_NO_FATAL_FAILURE(start_on_probation());
  ASSERT_EQ(daemon->ask("change.confirm")["saved"], true);

  crash(*daemon);
  daemon->start();

  EXPECT_EQ(state_of("second"), "running");
  EXPECT_FALSE(daemon->component("second").contains("stopped_by"));
}

TEST_F(UserStop, StandsAgainstAReloadOfItsPlugin) {
  begin();
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  daemon->install(3);
  ASSERT_EQ(daemon->ask("plugin.reload", {{"plugin", "trial"}})["state"], "applied");
  EXPECT_TRUE(stands());
  ASSERT_EQ(daemon->ask("change.undo")["state"], "applied");
  EXPECT_TRUE(stands());
}

TEST_F(UserStop, StandsAgainstARuleThatStartsIt) {
  begin(supervised(R"({ "name": "up", "when": "first.core.gain > 5", "do": "wake" },
                      { "name": "both", "when": "first.core.gain > 7",
                        "do": [{ "start": "second" }, { "disconnect": "second.ports.input" }] })"));
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);

  daemon->set("first.core.gain", 6.0);
  ASSERT_TRUE(daemon->fired("up", 1)) << daemon->rule("up");
  EXPECT_THAT(daemon->answer("up"), HasSubstr("unchanged, generation"));
  EXPECT_TRUE(daemon->logs(1, "transaction_applied", "second stays stopped: uid "));
  EXPECT_TRUE(stands());

  daemon->set("first.core.gain", 8.0);
  ASSERT_TRUE(daemon->fired("both", 1)) << daemon->rule("both");
  EXPECT_THAT(daemon->answer("both"), HasSubstr("applied, generation"));
  EXPECT_TRUE(daemon->logs(2, "transaction_applied", "second stays stopped: uid "));
  EXPECT_EQ(daemon->service("second.ports.input"), nullptr) << "the rest of it is done";
  EXPECT_TRUE(stands());
}

TEST_F(UserStop, StandsAgainstARequestOfAComponent) {
  begin(supervised("", R"(["wake"])"));
  ASSERT_EQ(daemon->ask("component.stop", kSecondOnly)["saved"], true);
  daemon->ask(
      "core.swap",
      {{"component", "first"}, {"core", "trial/requesting"}, {"set", {{"transaction", "wake"}}}});
  ASSERT_TRUE(eventually([&] { return daemon->events("transaction_applied", "wake") > 0; }));
  EXPECT_TRUE(stands());
}

}  // namespace
}  // namespace mauve::test
