// SPDX-License-Identifier: LGPL-3.0-or-later
// A whole file against the running system: diff, plan and apply, with the real daemon and client.
#include <algorithm>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The trial architecture with one piece of its text replaced.
std::string with(const std::string& what, const std::string& by, std::string text = kTrial) {
  const auto found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return found == std::string::npos ? text : text.replace(found, what.size(), by);
}

const std::string kSecond = R"("second": { "type": "trial/unit", "properties")";
const std::string kInput = R"("ports": { "input": "signal.read" })";

/// A property, a core with a property, and a connection less.
std::string with_edits() {
  auto text = with(R"({ "fsm.period": "2ms" })", R"({ "fsm.period": "2ms", "core.gain": 2.5 })");
  text = with(kSecond + R"(: { )",
              R"("second": { "type": "trial/unit", "core": "trial/other", "properties": )"
              R"({ "core.gain": 4, )",
              text);
  return with(kInput, R"("ports": {})", text);
}

class Apply : public testing::Test {
 protected:
  void SetUp() override { static_cast<void>(daemon_.client()); }

  /// mauvectl VERB FILE with this text in the file.
  Said ctl(const std::string& verb, const std::string& text, std::vector<std::string> more = {}) {
    const auto file = daemon_.place().write("wanted.json", text).string();
    more.insert(more.begin(), {verb, file});
    return daemon_.ctl(more);
  }
  [[nodiscard]] std::string client_errors() const {
    return TempDir::read(daemon_.place() / "client.txt");
  }
  Json generation() { return daemon_.ask("status.get")["generation"]; }
  /// A second plugin where the daemon looks for them; it is not loaded.
  void install_demo() {
    std::filesystem::copy_file(MAUVE_PLUGIN_DIR "/demo.so", daemon_.plugins() / "demo.so");
  }
  std::vector<std::string> plugins() {
    std::vector<std::string> names;
    const auto answer = daemon_.ask("plugin.list");
    for (const auto& plugin : answer["items"]) {
      names.push_back(plugin["name"]);
    }
    return names;
  }

  TrialDaemon daemon_;
};

TEST_F(Apply, NotesThatItStartsAComponentThatAChangeStopped) {
  auto without = Json::parse(kTrial);
  without["components"]["second"]["start"] = false;  // a file stops it, and no user
  const Json stop = {{"text", without.dump()}};
  ASSERT_EQ(daemon_.ask("architecture.apply", stop)["state"], "applied");

  const auto plan = ctl("plan", kTrial);
  EXPECT_THAT(plan.out, HasSubstr("note: second will start: it was stopped"));
  const auto applied = daemon_.ask("architecture.apply", {{"text", kTrial}});
  EXPECT_THAT(applied["notes"].dump(), HasSubstr("second starts: it was stopped"));
  EXPECT_EQ(daemon_.component("second")["state"], "running");
}

TEST_F(Apply, ChangesNothingForTheFileThatRuns) {
  const auto diff = ctl("diff", kTrial);
  EXPECT_EQ(diff.exit, 0);
  EXPECT_THAT(diff.out, HasSubstr("is what runs (generation 1)"));

  const auto applied = ctl("apply", kTrial);
  EXPECT_EQ(applied.exit, 0);
  EXPECT_THAT(applied.out, HasSubstr("nothing to change (generation 1 still running)"));
  EXPECT_EQ(generation(), 1);
}

TEST_F(Apply, SaysWhatDiffersWithExitCode1) {
  const auto diff = ctl("diff", with_edits());

  EXPECT_EQ(diff.exit, 1);
  EXPECT_THAT(diff.out, HasSubstr("~ first.core.gain: 1 -> 2.5\n"));
  EXPECT_THAT(diff.out, HasSubstr("~ second.core: trial/steady -> trial/other\n"));
  EXPECT_THAT(diff.out, HasSubstr("- second.ports.input: signal.read\n"));
  EXPECT_EQ(generation(), 1);
}

TEST_F(Apply, EndsADiffOfABadFileWithExitCode2) {
  EXPECT_EQ(ctl("diff", "{").exit, 2);
  EXPECT_EQ(ctl("diff", with("trial/unit", "trial/unti")).exit, 2);
}

TEST_F(Apply, PutsEverythingInForceAtOnce) {
  ASSERT_TRUE(eventually([&] { return daemon_.value("second.core.count") >= 10; }));

  const auto applied = ctl("apply", with_edits(), {"--json"});

  ASSERT_EQ(applied.exit, 0) << applied.out << client_errors();
  const auto result = Json::parse(applied.out);
  EXPECT_EQ(result["generation"], 2);
  EXPECT_EQ(result["state"], "applied");
  EXPECT_EQ(result["lines"].size(), 4U) << result;
  EXPECT_EQ(result["components"].size(), 2U);
  EXPECT_EQ(daemon_.value("first.core.gain"), 2.5);
  EXPECT_EQ(daemon_.value("second.core.gain"), 4.0);
  EXPECT_EQ(daemon_.component("second")["core"], "trial/other");
  Json count = 0;  // until the first job of the new core
  ASSERT_TRUE(eventually([&] { return (count = daemon_.value("second.core.count")) != 0; }));
  EXPECT_GE(count, 10) << "its state was handed over";
  EXPECT_TRUE(daemon_.becomes("second.core.input", 0.5)) << "the port has its default";
  EXPECT_TRUE(daemon_.becomes("signal.read", 2.5));
  EXPECT_EQ(ctl("diff", with_edits()).exit, 0) << "what runs is what the file says";
}

TEST_F(Apply, GoesBackToTheFirstFile) {
  ASSERT_EQ(ctl("apply", with_edits()).exit, 0);

  ASSERT_EQ(ctl("apply", kTrial).exit, 0) << client_errors();

  EXPECT_EQ(generation(), 3);
  EXPECT_EQ(daemon_.value("first.core.gain"), 1.0);
  EXPECT_EQ(daemon_.component("second")["core"], "trial/steady");
  EXPECT_TRUE(daemon_.becomes("second.core.input", 1.0));
  EXPECT_EQ(ctl("diff", kTrial).exit, 0);
}

/// With a resource that has a lock, and says how long it is held.
std::string with_meter(const std::string& hold) {
  const std::string count = R"("count": { "type": "shared_data", "data": "int64" })";
  return with(count, count + R"(, "meter": { "type": "trial/meter")" + hold + " }");
}

TEST_F(Apply, ChangesHowLongAResourceIsHeld) {
  ASSERT_EQ(ctl("apply", with_meter(R"(, "lock_budget": "50us")")).exit, 0) << client_errors();
  ASSERT_EQ(daemon_.ask("object.get", {{"address", "meter"}})["lock_budget"], "50us");

  const auto diff = ctl("diff", with_meter(R"(, "lock_budget": "1.5ms")"));
  const auto applied = ctl("apply", with_meter(R"(, "lock_budget": "1.5ms")"), {"--json"});

  EXPECT_EQ(diff.exit, 1);
  EXPECT_THAT(diff.out, HasSubstr("~ meter.lock_budget: 50us -> 1.5ms\n"));
  ASSERT_EQ(applied.exit, 0) << applied.out << client_errors();
  const auto receipt = Json::parse(applied.out);
  ASSERT_EQ(receipt["components"].size(), 1U) << "no thread takes part: " << receipt;
  EXPECT_EQ(receipt["components"][0]["name"], "meter");
  EXPECT_EQ(daemon_.ask("object.get", {{"address", "meter"}})["lock_budget"], "1.5ms");
  EXPECT_EQ(ctl("diff", with_meter(R"(, "lock_budget": "1.5ms")")).exit, 0) << "what runs says so";
  ASSERT_EQ(ctl("apply", with_meter("")).exit, 0);
  EXPECT_EQ(daemon_.ask("object.get", {{"address", "meter"}})["lock_budget"], "0s");
}

TEST_F(Apply, DoesNoPartOfItWhenAnotherCannotBePrepared) {
  const auto text = with(R"("type": "trial/unit", "properties": { "fsm.period": "5ms")",
                         R"("type": "trial/unit", "core": "trial/refusing", "properties": )"
                         R"({ "fsm.period": "5ms")");
  const auto both =
      with(R"({ "fsm.period": "2ms" })", R"({ "fsm.period": "2ms", "core.gain": 2.5 })", text);

  const auto applied = ctl("apply", both);

  EXPECT_EQ(applied.exit, 1);
  EXPECT_THAT(client_errors(), HasSubstr("is not to its liking"));
  EXPECT_THAT(client_errors(), HasSubstr("unchanged (generation 1 still running)"));
  EXPECT_EQ(generation(), 1);
  EXPECT_EQ(daemon_.value("first.core.gain"), 1.0);
  EXPECT_EQ(daemon_.component("second")["core"], "trial/steady");
}

TEST_F(Apply, ReportsAllErrorsOfAFileWithTheirPlaces) {
  auto text = with(R"("2ms")", R"("2")");
  text = with("signal.read", "signal.reed", text);

  const auto applied = ctl("apply", text);

  EXPECT_EQ(applied.exit, 1);
  EXPECT_THAT(client_errors(), HasSubstr("wanted.json:10:"));
  EXPECT_THAT(client_errors(), HasSubstr("error: first.fsm.period: \"2\" has no unit"));
  EXPECT_THAT(client_errors(), HasSubstr("wanted.json:13:"));
  EXPECT_THAT(client_errors(), HasSubstr(": the file has 2 errors\n"));
  EXPECT_EQ(generation(), 1);
}

TEST_F(Apply, PreparesAndDropsInADryRun) {
  for (const auto* verb : {"plan", "apply"}) {
    std::vector<std::string> more = {"--json"};
    if (verb == std::string("apply")) {
      more.emplace_back("--dry-run");
    }
    const auto planned = ctl(verb, with_edits(), more);

    ASSERT_EQ(planned.exit, 0) << planned.out;
    const auto result = Json::parse(planned.out);
    EXPECT_EQ(result["state"], "unchanged");
    EXPECT_EQ(result["dry_run"], true);
    EXPECT_EQ(result["lines"].size(), 4U);
    ASSERT_EQ(result["components"].size(), 2U);
    EXPECT_EQ(result["components"][1]["name"], "second");
    EXPECT_EQ(result["components"][1]["bytes"], 8);
  }
  EXPECT_EQ(generation(), 1);
  EXPECT_EQ(daemon_.value("first.core.gain"), 1.0);
}

TEST_F(Apply, RefusesInADryRunWhatCannotBePrepared) {
  const auto text = with(R"("type": "trial/unit", "properties": { "fsm.period": "5ms")",
                         R"("type": "trial/unit", "core": "trial/throwing_hook", "properties": )"
                         R"({ "fsm.period": "5ms")");

  EXPECT_EQ(ctl("plan", text).exit, 1);
  EXPECT_THAT(client_errors(), HasSubstr("no such device"));
}

TEST_F(Apply, ParksAndStartsAsTheFileSays) {
  const auto parked = with(kInput, kInput + R"(, "start": false)");

  ASSERT_EQ(ctl("apply", parked).exit, 0) << client_errors();
  EXPECT_EQ(daemon_.component("second")["state"], "stopped");
  EXPECT_EQ(ctl("diff", parked).exit, 0);
  EXPECT_EQ(ctl("diff", kTrial).exit, 1);

  ASSERT_EQ(ctl("apply", kTrial).exit, 0) << client_errors();
  EXPECT_EQ(daemon_.component("second")["state"], "running");
}

TEST_F(Apply, LoadsThePluginsThatTheFileNames) {
  install_demo();
  const auto text = with(R"(["trial"])", R"(["trial", "demo"])");

  EXPECT_THAT(ctl("diff", text).out, HasSubstr("+ plugin demo\n"));
  EXPECT_EQ(ctl("plan", text).exit, 0);
  EXPECT_THAT(plugins(), ElementsAre("trial")) << "looking loads nothing";

  EXPECT_EQ(ctl("apply", text).exit, 0) << client_errors();
  EXPECT_THAT(plugins(), ElementsAre("demo", "trial"));
  EXPECT_EQ(generation(), 1) << "no component took part";
  EXPECT_EQ(ctl("diff", text).exit, 0);
}

TEST_F(Apply, LoadsNoPluginForAChangeThatIsRefused) {
  install_demo();
  auto text = with(R"(["trial"])", R"(["trial", "demo"])");
  text = with(R"("type": "trial/unit", "properties": { "fsm.period": "5ms")",
              R"("type": "trial/unit", "core": "trial/refusing", "properties": )"
              R"({ "fsm.period": "5ms")",
              text);

  EXPECT_EQ(ctl("apply", text).exit, 1);

  EXPECT_THAT(plugins(), ElementsAre("trial"));
  EXPECT_EQ(daemon_.ask("plugin.load", {{"plugin", "demo"}})["loaded"], true);
}

TEST_F(Apply, NamesTheOptionOfMauvedWhereAPluginIsMissing) {
  EXPECT_EQ(ctl("plan", with(R"(["trial"])", R"(["trial", "no_such"])")).exit, 1);

  EXPECT_THAT(
      client_errors(),
      HasSubstr("hint   : correct the file, or start mauved with --plugin-dir of that plugin; "
                "mauvectl check looks at it again"));
}

TEST_F(Apply, RefusesAnotherName) {
  const auto text = with(R"("name": "trial")", R"("name": "trail")");

  EXPECT_THAT(ctl("diff", text).out,
              HasSubstr("~ name: trial -> trail (apply refuses this: keep the name, or "));
  EXPECT_EQ(ctl("apply", text).exit, 1);
  EXPECT_THAT(client_errors(), HasSubstr("keep the name, or start mauved with this file"));
  EXPECT_EQ(generation(), 1);
}

TEST_F(Apply, RefusesWhenAnotherGenerationRuns) {
  EXPECT_EQ(ctl("apply", with_edits(), {"--if-generation", "7"}).exit, 6);
  EXPECT_EQ(generation(), 1);
}

TEST_F(Apply, LeavesOneAuditLineWithTheReason) {
  ASSERT_EQ(ctl("apply", with_edits(), {"--reason", "tuned in the field"}).exit, 0);

  const auto is_reported = [](const Json& record) {
    return record["event"] == "change_applied" &&
           record["fields"].value("reason", "") == "tuned in the field";
  };
  EXPECT_TRUE(eventually([&] {
    const auto records = daemon_.ask("log.tail")["records"];
    return std::count_if(records.begin(), records.end(), is_reported) == 1;
  })) << daemon_.ask("log.tail");
}

/// The signal becomes a queue: another contract for who writes it and who reads it.
std::string with_queue() {
  return with(R"("signal": { "type": "shared_data")", R"("signal": { "type": "ring_buffer")");
}

TEST_F(Apply, LetsMembersWaitForEachOtherWhereAResourceChangesItsContract) {
  const auto planned = ctl("plan", with_queue());
  EXPECT_EQ(planned.exit, 0) << client_errors();
  EXPECT_THAT(planned.out, HasSubstr("at a barrier, for another contract of signal; may lose: "));
  ASSERT_TRUE(eventually([&] { return daemon_.value("second.core.count") >= 10; }));

  const auto applied = ctl("apply", with_queue(), {"--json"});

  ASSERT_EQ(applied.exit, 0) << applied.out << client_errors();
  const auto result = Json::parse(applied.out);
  EXPECT_EQ(result["sync"], "barrier");
  EXPECT_EQ(result["exchanged"], Json::array({"signal"}));
  const auto& rows = result["components"];
  const auto signal = std::find_if(rows.begin(), rows.end(),
                                   [](const Json& row) { return row["name"] == "signal"; });
  ASSERT_NE(signal, rows.end()) << result;
  EXPECT_EQ((*signal)["bytes"], 8) << "its latest value is the first item";
  EXPECT_GE(daemon_.value("second.core.count"), 10);
  EXPECT_TRUE(eventually([&] { return daemon_.value("second.core.count") >= 30; }));
  EXPECT_EQ(ctl("diff", with_queue()).exit, 0);
}

TEST(ApplyAtABarrier, LeavesTheOldGenerationAfterAPowerCut) {
  for (const std::string point : {"barrier.before_hand_over", "barrier.after_hand_over"}) {
    const TempDir state;
    setenv("MAUVE_FAIL", point.c_str(), 1);
    TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", state.path().string()},
                       MAUVE_TRIAL_DIR "/mauved_fail");
    unsetenv("MAUVE_FAIL");
    const auto before = daemon.ask("config.get")["architecture"];
    auto client = daemon.client();

    static_cast<void>(client.ask("architecture.apply", {{"text", with_queue()}}));  // no answer
    ASSERT_EQ(daemon.process().wait(), 86) << point << daemon.errors();
    daemon.start();

    EXPECT_EQ(daemon.ask("config.get")["architecture"], before) << point;
  }
}

TEST_F(Apply, LetsNoMemberWaitWhenTheRequestSaysCut) {
  const auto applied = ctl("apply", with_queue(), {"--sync", "cut", "--json"});

  ASSERT_EQ(applied.exit, 0) << applied.out << client_errors();
  EXPECT_FALSE(Json::parse(applied.out).contains("sync"));
  EXPECT_EQ(ctl("apply", kTrial, {"--sync", "soon"}).exit, 2);
  EXPECT_THAT(client_errors(), HasSubstr("one of: cut barrier"));
}

TEST_F(Apply, LetsMembersWaitForEachOtherWhenTheRequestSaysSo) {
  const auto applied = ctl("apply", with_edits(), {"--sync", "barrier"});

  ASSERT_EQ(applied.exit, 0) << applied.out << client_errors();
  EXPECT_THAT(applied.out, HasSubstr("\nat a barrier\n"));
  EXPECT_TRUE(daemon_.becomes("signal.read", 2.5));
}

TEST_F(Apply, ExportsWhatItAppliesAgain) {
  ASSERT_EQ(ctl("apply", with_edits()).exit, 0);
  const auto exported = daemon_.ask("config.get")["architecture"].dump();

  EXPECT_EQ(ctl("diff", exported).exit, 0);
  EXPECT_THAT(ctl("apply", exported).out, HasSubstr("nothing to change"));
}

}  // namespace
}  // namespace mauve::test
