// SPDX-License-Identifier: LGPL-3.0-or-later
// Files of clients are judged in a process of its own: nothing in them reaches the daemon.
#include <csignal>
#include <sstream>

#include "rt/thread/run_guarded.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// The architecture of the test with this core in `first`.
std::string with_core(const std::string& core) {
  std::string text(kTrial);
  const std::string name = R"("trial/unit",)";
  return text.replace(text.find(name), name.size(), name + R"( "core": ")" + core + R"(",)");
}

/// mauved with a core that hangs while a file of the test is there.
class Judging : public testing::Test {
 protected:
  void SetUp() override { begin("60s"); }
  void begin(const std::string& within) {
    setenv("MAUVE_TRIAL_WAITS", gate_.c_str(), 1);
    daemon_ = std::make_unique<TrialDaemon>(
        kTrial, std::vector<std::string>{"--realtime", "off", "--prepare-within", within});
    unsetenv("MAUVE_TRIAL_WAITS");
    static_cast<void>(daemon_->client());
    static_cast<void>(files_.write("gate", "closed"));
  }

  Json ask(const std::string& method, const std::string& text) {
    return daemon_->ask(method, {{"text", text}});
  }
  /// Both refuse this core; nothing of it is left in the daemon.
  void expect_refused(const std::string& core, const std::string& name, const std::string& said) {
    for (const char* method : {"config.check", "architecture.diff"}) {
      const auto error = ask(method, with_core(core));
      EXPECT_EQ(error["data"]["name"], name) << method << error;
      EXPECT_EQ(error["data"]["where"], "first.core") << method << error;
      EXPECT_EQ(error["data"]["state"], "unchanged");
      EXPECT_THAT(error["message"].get<std::string>(), HasSubstr(said));
    }
    EXPECT_EQ(daemon_->ask("status.get")["abandoned_threads"], Json::array());
    EXPECT_EQ(daemon_->component("first")["core"], "trial/steady");
    EXPECT_EQ(daemon_->component("first")["state"], "running");
  }

  TempDir files_;
  const std::string gate_ = (files_ / "gate").string();
  std::unique_ptr<TrialDaemon> daemon_;
};

TEST_F(Judging, NotesWhatAStartNotes) {
  const auto note = HasSubstr("second.ports.output is not connected");
  std::string lost(kTrial);
  const std::string connection = R"("ports": { "output": "signal.write" })";
  lost.replace(lost.find(connection), connection.size(), R"("ports": {})");

  EXPECT_TRUE(daemon_->says("second.ports.output is not connected"));
  EXPECT_THAT(ask("config.check", kTrial)["notes"].dump(), note);
  EXPECT_FALSE(ask("architecture.diff", kTrial).contains("notes")) << "as it runs already";
  EXPECT_THAT(ask("architecture.diff", lost)["notes"].dump(),
              HasSubstr("first.ports.output is not connected"));
}

TEST_F(Judging, OutlivesAConstructorThatDoesNotReturn) {
  begin("4s");
  expect_refused("trial/stuck_constructor", "timed_out", "constructor did not return within 4s");
}

/// In mauved itself, where they are no part of a file.
TEST_F(Judging, HooksThatCrashOrLeaveAreRefusedAndTheDaemonRunsOn) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer reports a crash in its own way";
  const std::vector<std::pair<std::string, std::string>> hooks = {
      {"trial/crashing_hook", "on_configure crashed: SIGSEGV at address 0x0"},
      {"trial/overflowing_hook", ", as its stack is full"},
      {"trial/leaving_hook", "on_configure called exit()"},
      {"trial/forking_hook", "on_configure called fork(), which changes the whole process"},
      {"trial/exiting_constructor", "constructor called exit(3)"}};
  for (const auto& [core, said] : hooks) {
    const auto error = daemon_->ask("core.swap", {{"component", "first"}, {"core", core}});
    EXPECT_EQ(error["data"]["name"], "hook_threw") << error;
    EXPECT_EQ(error["data"]["where"], "first.core");
    EXPECT_EQ(error["data"]["state"], "unchanged");
    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr(said));
  }
  EXPECT_EQ(daemon_->component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon_->component("first")["state"], "running");
}

/// In the process of its own, and in mauved whether its memory is locked or not.
TEST_F(Judging, HooksHaveAStackOfEightMegabytesWhereverTheyRun) {
  for (const std::string realtime : {"off", "prefer"}) {
    TrialDaemon daemon(kTrial, {"--realtime", realtime});
    static_cast<void>(daemon.client());

    EXPECT_EQ(daemon.ask("config.check", {{"text", with_core("trial/roomy_hook")}})["errors"],
              Json::array());
    const auto swapped = daemon.ask(
        "core.swap", {{"component", "first"}, {"core", "trial/roomy_hook"}, {"probation", "off"}});
    EXPECT_EQ(swapped["state"], "applied") << swapped;
  }
}

TEST_F(Judging, OutlivesAConstructorThatEndsTheProcess) {
  expect_refused("trial/exiting_constructor", "plugin_refused", "with exit code ");
}

TEST_F(Judging, OutlivesAConstructorThatCrashes) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer reports a crash in its own way";
  expect_refused("trial/crashing_constructor", "plugin_refused", "SIGSEGV");
}

TEST_F(Judging, HasABoundOnMemory) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer reserves terabytes";
  std::ostringstream text;
  text << R"({"schema": "mauve/architecture/1", "name": "trial", "plugins": ["trial"],
             "components": {)";
  for (int i = 0; i < 8; ++i) {
    text << (i == 0 ? "" : ",") << "\"c" << i
         << R"(": { "type": "trial/unit", "core": "trial/hoarding_constructor" })";
  }
  text << "}}";

  const auto errors = ask("config.check", text.str())["errors"];

  ASSERT_FALSE(errors.empty()) << "eight sixteenths of the memory are more than a quarter";
  EXPECT_THAT(errors.back()["message"].get<std::string>(), HasSubstr("bad_alloc"));
}

TEST_F(Judging, LooksAtTwoFilesOfAUserAtATimeAndNeverHoldsUpAChange) {
  auto client = daemon_->client();
  const auto text = with_core("trial/stuck_constructor");
  for (int id = 1; id <= 4; ++id) {
    ASSERT_TRUE(
        client.send(protocol::make_request(id, "config.check", {{"text", text}}).dump() + "\n"));
  }
  const auto third = client.json();
  const auto fourth = client.json();
  EXPECT_EQ(third["id"], 3);
  EXPECT_EQ(fourth["id"], 4);
  EXPECT_EQ(third["error"]["data"]["name"], "limit") << third;

  for (int i = 0; i < 5; ++i) {
    const auto set = daemon_->ask("param.set", {{"values", {{"second.core.gain", 2.0 + i}}}});
    EXPECT_EQ(set["state"], "applied") << set;
  }
  EXPECT_EQ(daemon_->ask("component.stop", {{"all", true}})["state"], "applied");
  std::filesystem::remove(gate_);
  for (int id = 1; id <= 2; ++id) {
    const auto judged = client.json();
    EXPECT_EQ(judged["id"], id);
    EXPECT_EQ(judged["result"]["errors"], Json::array()) << judged;
  }
}

TEST_F(Judging, DoesNotHoldUpTheEnd) {
  auto client = daemon_->client();
  const auto text = with_core("trial/stuck_constructor");
  ASSERT_TRUE(
      client.send(protocol::make_request(1, "config.check", {{"text", text}}).dump() + "\n"));
  ASSERT_TRUE(eventually([&] { return daemon_->ask("ping")["pong"] == true; }));

  daemon_->process().signal(SIGTERM);

  EXPECT_EQ(daemon_->process().wait(), 0) << daemon_->errors();
}

/// An apply first tries the elements that it would make.
TEST_F(Judging, TriesTheElementsOfAnApplyBeforeTheyAreMadeInTheDaemon) {
  begin("10s");
  auto cores = std::vector<std::string>{"trial/exiting_constructor", "trial/stuck_constructor"};
  if (rt::kGuardsFaults) cores.emplace_back("trial/crashing_constructor");
  for (const auto& core : cores) {
    const auto error = ask("architecture.apply", with_core(core));
    EXPECT_EQ(error["data"]["where"], "first.core") << error;
    EXPECT_EQ(error["data"]["state"], "unchanged");
    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("process in which it was tried"));
  }
  EXPECT_EQ(daemon_->ask("status.get")["abandoned_threads"], Json::array());
  EXPECT_EQ(ask("architecture.apply", with_core("trial/other"))["state"], "applied");
}

TEST_F(Judging, ComparesAFileWithWhatRunsAndSaysWhatStoppedIs) {
  auto without = Json::parse(kTrial);
  without["components"]["second"]["start"] = false;  // a file stops it, and no user
  ASSERT_EQ(ask("architecture.apply", without.dump())["state"], "applied");
  std::string text(kTrial);
  text.replace(text.find("2ms"), 3, "3ms");

  const auto lines = ask("architecture.diff", text)["lines"];

  ASSERT_EQ(lines.size(), 2U) << lines;
  EXPECT_EQ(lines[0]["address"], "first.fsm.period");
  EXPECT_EQ(lines[0]["old"], "2ms");
  EXPECT_EQ(lines[1]["address"], "second.start");
  EXPECT_EQ(lines[1]["new"], true);
}

TEST_F(Judging, SaysWhenTheFilesOfNowAreOthersThanThoseThatRun) {
  std::filesystem::remove(daemon_->plugins() / "trial.so");

  const auto error = ask("architecture.diff", R"({"schema": "mauve/architecture/1", "name": "t"})");

  EXPECT_EQ(error["data"]["name"], "wrong_state") << error;
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("plugin files of now"));
}

}  // namespace
}  // namespace mauve::test
