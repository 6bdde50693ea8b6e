// SPDX-License-Identifier: LGPL-3.0-or-later
// mauvectl doctor, asked about a running mauved.
#include <cstdint>
#include <fstream>

#include "support/notify_socket.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

/// The findings of `mauvectl doctor`, by check.
Json findings_of(TrialDaemon& daemon) {
  static_cast<void>(daemon.ask("ping"));
  const auto result = Json::parse(daemon.ctl({"--json", "doctor"}).out, nullptr, false);
  EXPECT_TRUE(result.is_object());
  Json all = Json::object();
  for (const auto& one : result["findings"]) {
    all[one["check"].get<std::string>()] = one;
  }
  return all;
}

TEST(DoctorOfADaemon, FindsWhatThisOneHasAndNoMore) {
  TrialDaemon daemon;

  const auto found = findings_of(daemon);

  EXPECT_EQ(found["mauved"]["grade"], "ok") << found["mauved"];
  EXPECT_EQ(found["versions"]["grade"], "ok") << found["versions"];
  EXPECT_EQ(found["policy in force"]["grade"], "warn") << "it was started with --realtime off";
  EXPECT_EQ(found["plugin directories"]["grade"], "ok") << found["plugin directories"];
  EXPECT_EQ(found["state directory"]["grade"], "warn") << "it keeps nothing";
  EXPECT_EQ(found["socket"]["grade"], "ok") << found["socket"];
}

TEST(DoctorOfADaemon, SeesAPluginDirectoryThatEverybodyMayWrite) {
  TrialDaemon daemon;
  static_cast<void>(daemon.ask("ping"));
  std::filesystem::permissions(daemon.plugins(), std::filesystem::perms::all);

  const auto found = findings_of(daemon)["plugin directories"];

  EXPECT_EQ(found["grade"], "fail") << found;
  EXPECT_EQ(found["remedy"], "chmod o-w " + daemon.plugins().string());
}

TEST(DoctorOfADaemon, FindsAndReportsWhatAnotherUserMayExchange) {
  TempDir state;
  std::filesystem::permissions(state.path(), std::filesystem::perms::all);
  const auto path = state.path().string();
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", path});

  const auto found = findings_of(daemon)["trusted paths"];

  EXPECT_EQ(found["grade"], "warn") << found;
  EXPECT_EQ(found["remedy"], "chmod o-w " + path);
  EXPECT_TRUE(daemon.says(path + ": may be written by everybody (it is the state directory)"))
      << daemon.errors();
}

TEST(DoctorOfADaemon, IsNotAskedByAServiceWhoseFilesOthersMayExchange) {
  TempDir open;
  std::filesystem::permissions(open.path(), std::filesystem::perms::all);
  const auto file =
      open.write("robot.json", R"({ "schema": "mauve/architecture/1", "name": "r" })");
  TempDir other;
  const auto errors = (other / "errors.txt").string();
  const std::string program = MAUVE_BIN_DIR "/mauved";
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), program);
    words.insert(words.end(), {"--realtime", "require"});
    Process daemon(words, errors);
    EXPECT_EQ(daemon.wait(), 1);
    const auto said = TempDir::read(errors);
    EXPECT_NE(said.find(open.path().string() + ": may be written by everybody"), std::string::npos)
        << said;
    return said;
  };

  EXPECT_NE(refused({file.string(), "--socket", (other / "s").string()})
                .find("it holds the architecture file"),
            std::string::npos);
  const auto good = other.write("robot.json", TempDir::read(file)).string();
  EXPECT_NE(refused({good, "--socket", (open / "s").string()}).find("it is the socket directory"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(open / "s.lock")) << "nothing was touched";
}

TEST(DoctorOfADaemon, SeesWhatOutlivesARun) {
  TempDir state;
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", state.path().string()});

  const auto found = findings_of(daemon);

  EXPECT_EQ(found["state directory"]["grade"], "ok") << found["state directory"];
  EXPECT_NE(found["disk space"]["found"].get<std::string>().find(state.path().string()),
            std::string::npos);
}

TEST(DoctorOfADaemon, IsAnsweredWithItsThreadsAndRights) {
  TrialDaemon daemon;

  const auto answer = daemon.ask("daemon.doctor");

  EXPECT_EQ(answer["pid"], daemon.process().id());
  EXPECT_EQ(answer["realtime"], "off");
  bool guard = false;
  for (const auto& thread : answer["threads"]) guard = guard || thread["name"] == "mauve-guard";
  EXPECT_TRUE(guard) << answer["threads"];
}

TEST(DoctorOfADaemon, LearnsWhetherItIsAService) {
  {
    const NotifySocket manager;
    TrialDaemon service;
    EXPECT_EQ(service.ask("daemon.doctor")["service"], true);
  }
  TrialDaemon daemon;
  EXPECT_EQ(daemon.ask("daemon.doctor")["service"], false);
}

/// The entry of the thread with this name, or null.
Json thread_called(TrialDaemon& daemon, const std::string& name) {
  const auto items = daemon.ask("daemon.threads")["items"];
  const auto found =
      std::ranges::find_if(items, [&](const Json& thread) { return thread["name"] == name; });
  return found == items.end() ? Json() : *found;
}

TEST(ThreadsOfADaemon, AreListedWithTheirUseOfTheProcessors) {
  TrialDaemon daemon;
  const auto before = thread_called(daemon, "first");
  ASSERT_TRUE(before.is_object());
  EXPECT_EQ(before["policy"], "SCHED_OTHER") << "it was started with --realtime off";
  EXPECT_GT(before["id"], 0);
  EXPECT_TRUE(thread_called(daemon, "mauve-control").is_object());
  EXPECT_TRUE(thread_called(daemon, "nobody").is_null());
  std::int64_t own = 0;
  if (!(std::ifstream("/proc/self/schedstat") >> own) || own == 0) {
    GTEST_SKIP() << "SKIPPED: this kernel has no schedstat";
  }
  ASSERT_TRUE(before["ran_ns"].is_number()) << before;

  EXPECT_TRUE(eventually([&] {
    const auto now = thread_called(daemon, "first");
    return now["ran_ns"] > before["ran_ns"] && now["waits"] > before["waits"];
  }));
}

TEST(ThreadsOfADaemon, AreATableForPeople) {
  TrialDaemon daemon;
  ASSERT_FALSE(daemon.ask("ping").is_null());

  const auto said = daemon.ctl({"threads"});

  EXPECT_EQ(said.exit, 0);
  EXPECT_THAT(said.out, testing::HasSubstr("NAME"));
  EXPECT_THAT(said.out, testing::HasSubstr("READY"));
  EXPECT_THAT(said.out,
              testing::ContainsRegex("\nmauve-control +SCHED_OTHER +0 +[0-9]+ +[0-9.]+ "));
}

}  // namespace
}  // namespace mauve::test
