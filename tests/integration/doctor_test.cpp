// SPDX-License-Identifier: LGPL-3.0-or-later
// mauvectl doctor, asked about a running mauved.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using Json = protocol::Json;

/// What `mauvectl doctor` finds, by check.
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

}  // namespace
}  // namespace mauve::test
