// SPDX-License-Identifier: LGPL-3.0-or-later
// A generation has no code: it records the builds of its plugins, and answers say when others run.
#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

const Json kTrialAgain = {{"plugin", "trial"}};

class BuildsOfPlugins : public Generations {
 protected:
  /// "9651293e" of the plugin that runs.
  [[nodiscard]] std::string build() { return short_of(plugin()["build_id"]); }
  [[nodiscard]] Json plugin() { return daemon.ask("plugin.list")["items"][0]; }
  [[nodiscard]] std::string recorded() { return short_of(newest(daemon)["builds"]["trial"]); }
  [[nodiscard]] Json status_notes() {
    Json notes = Json::array();
    const auto status = daemon.ask("status.get");
    for (const auto& note : status["notes"]) {
      if (note["address"] == "trial") {
        notes.push_back(note["text"]);
      }
    }
    return notes;
  }
  [[nodiscard]] std::string file() const { return (daemon.plugins() / "trial.so").string(); }

  TrialDaemon daemon{kTrial, options()};

  static std::string short_of(const Json& build_id) {
    return build_id.get<std::string>().substr(0, 8);
  }
};

TEST_F(BuildsOfPlugins, AreNamedByAStartAfterACrashWhereOthersRun) {
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  const auto before = build();
  EXPECT_EQ(recorded(), before);
  crash(daemon);
  daemon.install(2);

  daemon.start();

  const auto now = build();
  ASSERT_NE(now, before);
  const auto remedy =
      "put build " + before + " in place of " + file() + ", then mauvectl reload trial";
  EXPECT_TRUE(daemon.says("generation 1 ran build " + before + " of plugin trial, and build " +
                          now + " runs now: " + remedy))
      << daemon.errors();
  ASSERT_EQ(status_notes().size(), 1U);
  EXPECT_THAT(status_notes()[0].get<std::string>(), HasSubstr(remedy));
  EXPECT_EQ(recorded(), now) << "of the generation that runs";

  daemon.install(1);
  ASSERT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
  EXPECT_TRUE(status_notes().empty()) << "the former build runs again";
}

TEST_F(BuildsOfPlugins, AreNamedByNoStartThatRunsTheSame) {
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  crash(daemon);

  daemon.start();

  EXPECT_TRUE(status_notes().empty());
  EXPECT_THAT(daemon.errors(), testing::Not(HasSubstr("of plugin trial, and build")));
}

TEST_F(BuildsOfPlugins, AreRecordedAnewByAReloadAndItsUndo) {
  const auto first = recorded();
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", kTrialAgain)["saved"], true);
  ASSERT_NE(recorded(), first);

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_TRUE(eventually([&] { return newest(daemon)["generation"] == 3; }));
  EXPECT_EQ(recorded(), first);
}

TEST_F(BuildsOfPlugins, AreNamedByAnUndoThatLeavesTheFileOfTheOther) {
  const auto former = build();
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
  const auto undone_build = build();
  const auto leaves = file() + " held build " + undone_build +
                      " at the reload, and the next start or reload of trial loads this file: put "
                      "build " +
                      former + " in its place";

  const auto plan = daemon.ask("change.undo", {{"dry_run", true}});
  const auto undone = daemon.ask("change.undo");

  EXPECT_EQ(plan["notes"], Json({"an undo changes no file: " + leaves})) << plan;
  EXPECT_EQ(undone["notes"], plan["notes"]) << undone;
  EXPECT_EQ(build(), former);
  EXPECT_TRUE(eventually([&] { return daemon.errors().find(leaves) != std::string::npos; }))
      << daemon.errors();
}

TEST_F(BuildsOfPlugins, AreNotBroughtBackByARollbackToAGenerationThatSaysSo) {
  const auto former = build();
  daemon.install(2);
  const Json unproven = {{"plugin", "trial"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("plugin.reload", unproven)["saved"], true);
  const auto remedy =
      "put build " + former + " in place of " + file() + ", then mauvectl reload trial";
  const Json notes = {"generation 1 ran build " + former + " of trial, and build " + build() +
                      " runs: a rollback brings no code back; " + remedy};

  const auto plan = daemon.ask("config.rollback", {{"generation", 1}, {"dry_run", true}});
  const auto same = daemon.ask("config.rollback", {{"generation", 1}});
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  const auto back = daemon.ask("config.rollback", {{"generation", 1}});

  EXPECT_EQ(plan["notes"], notes) << plan;
  EXPECT_EQ(same["changed"], false) << same;
  EXPECT_EQ(same["notes"], notes) << same;
  EXPECT_EQ(back["changed"], true) << back;
  EXPECT_EQ(back["notes"][0], notes[0]) << back;
  EXPECT_THAT(daemon.ctl({"rollback", "1"}).out, HasSubstr("a rollback brings no code back"));
  EXPECT_FALSE(daemon.ask("config.rollback", {{"generation", 2}}).contains("notes"));
}

TEST_F(BuildsOfPlugins, AreTheHintOfARollbackToAGenerationThatTheyCannotRun) {
  const auto former = build();
  for (const auto* core : {"trial/former", "trial/other"}) {
    ASSERT_EQ(daemon.ctl({"swap-core", "first", core, "--probation=off"}).exit, 0);
  }
  daemon.install(2);
  const Json unproven = {{"plugin", "trial"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("plugin.reload", unproven)["saved"], true);

  const auto refused = daemon.ctl({"rollback", "2"});

  EXPECT_EQ(refused.exit, 1);
  EXPECT_THAT(refused.err, testing::ContainsRegex("generation 2:[0-9]+:[0-9]+: error: .*former"));
  EXPECT_THAT(refused.err, HasSubstr("generation 2 cannot run with the plugins of now: its file "
                                     "has 1 error\n"));
  EXPECT_THAT(refused.err, HasSubstr("hint   : it ran build " + former + " of trial, and build " +
                                     build() + " runs: put build " + former + " in place of "));
}

TEST_F(BuildsOfPlugins, AreTheHintOfAnUndoOfAReloadThatIsOffProbation) {
  const auto former = build();
  daemon.install(2);
  const Json unproven = {{"plugin", "trial"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("plugin.reload", unproven)["saved"], true);

  const auto refused = daemon.ask("change.undo");

  EXPECT_EQ(refused["data"]["hint"], "put build " + former + " in place of " + file() +
                                         ", then mauvectl reload trial; a rollback brings no code "
                                         "back");
}

TEST_F(BuildsOfPlugins, AreComparedWithTheFilesOnDiskByPluginsAndDiff) {
  const auto before = build();
  const auto text = exported(daemon).dump();
  EXPECT_FALSE(plugin().contains("build_on_disk"));
  EXPECT_FALSE(daemon.ask("architecture.diff", {{"text", text}}).contains("notes"));
  daemon.install(2);

  const auto row = plugin();
  const auto diff = daemon.ask("architecture.diff", {{"text", text}});

  ASSERT_TRUE(row.contains("build_on_disk")) << row;
  const auto on_disk = short_of(row["build_on_disk"]);
  EXPECT_EQ(build(), before);
  EXPECT_NE(on_disk, before);
  EXPECT_EQ(diff["same"], true) << diff;
  EXPECT_EQ(diff["notes"],
            Json({"trial runs build " + before + ", and its file holds build " + on_disk +
                  ", which the next start, or mauvectl reload trial, "
                  "loads"}));

  std::filesystem::remove(file());
  EXPECT_EQ(plugin()["build_on_disk"], nullptr);
}

TEST_F(BuildsOfPlugins, AreNoneOfTheNotesOfAnUndoThatConcernsNoReload) {
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 3.0}}}})["state"], "applied");

  EXPECT_FALSE(daemon.ask("change.undo").contains("notes"));
}

}  // namespace
}  // namespace mauve::test
