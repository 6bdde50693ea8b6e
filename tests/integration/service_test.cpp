// SPDX-License-Identifier: LGPL-3.0-or-later
// The life of mauved as a process: start, refusal, readiness, end.
#include <chrono>

#include "mauve/host/deploy_options.h"
#include "support/notify_socket.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

/// Far shorter than a hook of these tests hangs, and longer than a busy disk stands still.
constexpr std::chrono::seconds kEndsWithin{60};

TEST(Service, IsReadyWhenClientsAreServedAndSaysWhenItStops) {
  const NotifySocket manager;
  TrialDaemon daemon;

  const auto ready = manager.next();
  EXPECT_THAT(ready, HasSubstr("READY=1"));
  EXPECT_THAT(ready, HasSubstr("STATUS=trial: 2 of 2 components run, generation 1, "));
  EXPECT_TRUE(RawClient(daemon.socket()).connected());

  const Json tried = {{"values", {{"first.core.gain", 3.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", tried)["state"], "applied");
  EXPECT_TRUE(eventually([&] {
    return manager.next().find("generation 2 on probation, ") != std::string::npos;
  })) << "a line comes every two seconds";

  daemon.process().signal(SIGTERM);
  EXPECT_THAT(manager.next(), HasSubstr("STOPPING=1"));
}

TEST(Service, EndsInOrderOnSigterm) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());

  daemon.process().signal(SIGTERM);

  EXPECT_EQ(daemon.process().wait(), 0);
  EXPECT_FALSE(std::filesystem::exists(daemon.socket()));
  EXPECT_TRUE(daemon.says("stopping on SIGTERM")) << daemon.errors();
  EXPECT_TRUE(daemon.says("info    stopped")) << daemon.errors();
}

TEST(Service, EndsWhileClientsAreConnectedAndWatching) {
  TrialDaemon daemon;
  auto idle = daemon.client();
  auto watching = daemon.client();
  ASSERT_TRUE(watching.ask("watch.subscribe", {{"addresses", {"signal.read"}}}).contains("result"));

  daemon.process().signal(SIGINT);

  EXPECT_EQ(daemon.process().wait(), 0);
  EXPECT_TRUE(idle.closed_by_peer());
}

TEST(Service, EndsInBoundedTimeWhenACoreHangs) {
  TrialDaemon daemon(unguarded());
  auto client = daemon.client();
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":1,"method":"core.swap","params":)"
                          R"({"component":"first","core":"trial/hanging"}})"
                          "\n"));
  ASSERT_TRUE(client.json().contains("result"));
  ASSERT_TRUE(daemon.becomes("signal.read", 9.0));
  const auto begin = Clock::now();

  daemon.process().signal(SIGTERM);

  EXPECT_EQ(daemon.process().wait(), 1);
  EXPECT_LT(Clock::now() - begin, kEndsWithin);
  EXPECT_TRUE(daemon.says("first: did not come back")) << daemon.errors();
  EXPECT_FALSE(std::filesystem::exists(daemon.socket()));
}

/// A client whose swap hangs in the hook of the new core, for longer than any test lasts.
RawClient hanging_swap(TrialDaemon& daemon) {
  auto client = daemon.client();
  const auto marker = daemon.place() / "configuring";
  const Json request = {{"jsonrpc", "2.0"},
                        {"id", 1},
                        {"method", "core.swap"},
                        {"params",
                         {{"component", "first"},
                          {"core", "trial/slow"},
                          {"set", {{"configure_time", "100s"}, {"marker", marker.string()}}}}}};
  EXPECT_TRUE(client.send(request.dump() + "\n"));
  EXPECT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));
  return client;
}

TEST(Service, EndsInBoundedTimeWhileAChangeIsPrepared) {
  TrialDaemon daemon;
  const auto client = hanging_swap(daemon);
  const auto begin = Clock::now();

  daemon.process().signal(SIGTERM);

  EXPECT_EQ(daemon.process().wait(), 1) << "a thread was abandoned";
  EXPECT_LT(Clock::now() - begin, kEndsWithin);
}

TEST(Service, HurriesOnASecondSignal) {
  TrialDaemon daemon;
  const auto client = hanging_swap(daemon);
  daemon.process().signal(SIGTERM);
  ASSERT_TRUE(eventually([&] { return daemon.errors().find("stopping") != std::string::npos; }));
  const auto begin = Clock::now();

  daemon.process().signal(SIGTERM);

  EXPECT_EQ(daemon.process().wait(), 1);
  EXPECT_LT(Clock::now() - begin, kEndsWithin);
  EXPECT_TRUE(daemon.says("second signal")) << daemon.errors();
  // Whichever came first, the end of all components or the signal.
  EXPECT_THAT(daemon.errors(), testing::AnyOf(HasSubstr("after all components stopped"),
                                              HasSubstr("after the safe values were written")));
}

TEST(Service, EndsInBoundedTimeWhenAHookHangsAtTheStart) {
  TrialDaemon daemon(R"({
    "schema": "mauve/architecture/1", "name": "slow", "plugins": ["trial"],
    "components": { "a": { "type": "trial/unit", "core": "trial/slow",
                           "properties": { "core.configure_time": "100s" } } }
  })");
  ASSERT_TRUE(eventually([&] { return daemon.errors().find("loaded") != std::string::npos; }));
  const auto begin = Clock::now();

  daemon.process().signal(SIGTERM);

  EXPECT_EQ(daemon.process().wait(), 1);
  EXPECT_LT(Clock::now() - begin, kEndsWithin);
}

TEST(Service, RefusesASecondInstanceOnTheSameSocket) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  const auto errors = (daemon.place() / "second.txt").string();

  Process second(daemon.command(), errors);

  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(TempDir::read(errors), HasSubstr("another mauved"));
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Service, ClearsTheSocketOfOneThatWasKilled) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  daemon.process().signal(SIGKILL);
  static_cast<void>(daemon.process().wait());
  ASSERT_TRUE(std::filesystem::exists(daemon.socket()));

  daemon.start();

  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Service, ReportsAllErrorsOfAFileAndStartsNothing) {
  TrialDaemon daemon(R"({
    "schema": "mauve/architecture/1", "name": "bad", "plugins": ["trial", "nothere"],
    "components": { "a": { "type": "trial/unit", "core": "trial/stedy", "tsk": {} } }
  })");

  EXPECT_EQ(daemon.process().wait(), 1);

  const auto errors = daemon.errors();
  EXPECT_THAT(errors, testing::ContainsRegex("trial.json:2:[0-9]+: plugins.nothere"));
  EXPECT_THAT(errors, HasSubstr("did you mean \"trial/steady\"?"));
  EXPECT_THAT(errors, HasSubstr("unknown key \"tsk\""));
  EXPECT_FALSE(std::filesystem::exists(daemon.socket()));
}

TEST(Service, SaysInOneLineToTheServiceManagerWhyItDoesNotStart) {
  const NotifySocket manager;
  TrialDaemon daemon("{\n  \"schema\": \"mauve/architecture/1\",\n  \"nmae\": 1, \"tsk\": 2\n}\n");

  EXPECT_EQ(daemon.process().wait(), 1);
  const auto status = manager.next();
  EXPECT_THAT(status, testing::StartsWith("STATUS=refused: "));
  EXPECT_THAT(status, HasSubstr("trial.json: has 3 errors, the first in line 1: "));
  EXPECT_THAT(status, HasSubstr("\"name\" is missing"));
}

TEST(Service, RefusesAFileWhoseHooksRefuse) {
  TrialDaemon daemon(R"({
    "schema": "mauve/architecture/1", "name": "bad", "plugins": ["trial"],
    "components": { "a": { "type": "trial/unit", "core": "trial/throwing_hook" } }
  })");

  EXPECT_EQ(daemon.process().wait(), 1);
  EXPECT_TRUE(daemon.says("no such device")) << daemon.errors();
}

TEST(Check, NeedsNoSocketAndPrintsEveryErrorWithItsPlace) {
  const TempDir dir;
  const auto file = dir.write("bad.json", "{\n  \"schema\": 1,\n  \"nmae\": \"x\"\n}\n");
  const auto errors = (dir / "errors.txt").string();

  Process check({MAUVE_BIN_DIR "/mauved", "--check", file.string()}, errors);

  EXPECT_EQ(check.wait(), 1);
  EXPECT_THAT(TempDir::read(errors), HasSubstr("bad.json:2:"));
  EXPECT_THAT(TempDir::read(errors), HasSubstr("bad.json:3:3: unknown key \"nmae\""));
}

TEST(Check, SaysOnceThatAPluginIsMissing) {
  const TempDir dir;
  const auto errors = (dir / "errors.txt").string();
  const auto file = dir.write("bad.json", R"({
    "schema": "mauve/architecture/1", "name": "bad", "plugins": ["typs"],
    "resources": { "a": { "type": "shared_data", "data": "pose2d/1" },
                   "b": { "type": "shared_data", "data": "velocity/1" } }
  })");

  Process check({MAUVE_BIN_DIR "/mauved", "--check", file.string()}, errors);

  EXPECT_EQ(check.wait(), 1);
  EXPECT_THAT(TempDir::read(errors), HasSubstr("1 error in"));
}

TEST(Check, FailsUnderStrictAdmissionWhereAStartWould) {
  const TempDir dir;
  const auto errors = (dir / "errors.txt").string();
  // No budgets: nothing is proved.
  const std::vector<std::string> words{MAUVE_BIN_DIR "/mauved",
                                       MAUVE_ETC_DIR "/minimal.json",
                                       "--check",
                                       "--plugin-dir",
                                       MAUVE_PLUGIN_DIR,
                                       "--admission"};
  auto strict = words;
  strict.emplace_back("strict");
  auto warn = words;
  warn.emplace_back("warn");

  EXPECT_EQ(Process(strict, errors).wait(), 1);
  EXPECT_THAT(TempDir::read(errors), HasSubstr("not admitted: "));
  EXPECT_EQ(Process(warn, errors).wait(), 0);
}

TEST(Check, AcceptsTheArchitecturesThatAreShipped) {
  TempDir dir;
  const auto errors = (dir / "errors.txt").string();
  for (const std::string name : {"minimal", "playback", "replay", "yard", "rover"}) {
    Process check({MAUVE_BIN_DIR "/mauved", MAUVE_ETC_DIR "/" + name + ".json", "--check",
                   "--plugin-dir", MAUVE_PLUGIN_DIR},
                  errors);

    EXPECT_THAT(check.all_output(), testing::Not(HasSubstr("is not connected"))) << name;
    EXPECT_EQ(check.wait(), 0) << name << TempDir::read(errors);
  }
}

TEST(Check, NamesAConnectionThatIsForgotten) {
  TempDir dir;
  std::string text = TempDir::read(MAUVE_ETC_DIR "/yard.json");
  const std::string pose = R"("pose": { "connect": "pose.read", "max_age": "200ms" },)";
  const auto at = text.find(pose);
  ASSERT_NE(at, std::string::npos);
  text.erase(at, pose.size());
  const auto file = dir.write("yard.json", text);

  Process check(
      {MAUVE_BIN_DIR "/mauved", file.string(), "--check", "--plugin-dir", MAUVE_PLUGIN_DIR});

  EXPECT_THAT(check.all_output(), HasSubstr("note: control.ports.pose is not connected"));
  EXPECT_EQ(check.wait(), 0) << "it may be meant";
}

TEST(Log, IsJsonLinesInAFile) {
  const TempDir dir;
  const auto log = (dir / "log.jsonl").string();
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--log-file", log});
  static_cast<void>(daemon.client());
  daemon.process().signal(SIGTERM);
  ASSERT_EQ(daemon.process().wait(), 0);

  std::ifstream lines(log);
  std::vector<std::string> events;
  for (std::string line; std::getline(lines, line);) {
    const auto record = protocol::parse_json(line);
    ASSERT_TRUE(record) << line;
    events.push_back((*record)["event"]);
  }

  EXPECT_EQ(events.front(), "daemon_starting");
  EXPECT_THAT(events, testing::Contains("component_stopped"));
  EXPECT_EQ(events.back(), "daemon_stopped");
}

TEST(Realtime, IsRequiredInWordsThatNameWhatIsMissing) {
  if (geteuid() != 0 || !std::filesystem::exists("/usr/bin/setpriv")) {
    GTEST_SKIP() << "needs root and setpriv to give privileges away";
  }
  TrialDaemon daemon;
  auto words = daemon.command();
  const auto place = std::filesystem::temp_directory_path() / ("mauve-" + std::to_string(getpid()));
  for (auto& word : words) {
    if (word == daemon.socket().string()) {
      word = (place / "s").string();
    }
    word = word == "off" ? "require" : word;
  }
  words.insert(words.begin(),
               {"/usr/bin/setpriv", "--bounding-set=-sys_nice,-ipc_lock", "--inh-caps=-all",
                "/usr/bin/prlimit", "--rtprio=0:0", "--memlock=65536:65536"});
  const auto errors = (daemon.place() / "require.txt").string();

  Process refused(words, errors);

  EXPECT_EQ(refused.wait(), 1);
  EXPECT_THAT(TempDir::read(errors), HasSubstr("realtime: "));
  EXPECT_THAT(TempDir::read(errors), HasSubstr("CAP_SYS_NICE is missing"));
  std::filesystem::remove_all(place);
}

}  // namespace
}  // namespace mauve::test
