// SPDX-License-Identifier: LGPL-3.0-or-later
// The end of mauved: no end that it decides itself leaves an output as it was.
#include <csignal>
#include <cstdlib>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

/// `second` notes in `file` the sign of what `first` writes; `mute` never returns its value.
std::string with_a_driver(const std::string& file) {
  auto architecture = Json::parse(std::string(kTrial));
  architecture["resources"]["mute"] = {{"type", "trial/mute"}};
  architecture["components"]["second"]["core"] = "trial/noting";
  architecture["components"]["second"]["properties"]["core.file"] = file;
  return architecture.dump();
}

TEST(Leaving, WritesTheSafeValuesAlsoWhenNoCommandIsServedAnyMore) {
  const TempDir files;
  const auto gate = files.write("gate", "closed").string();
  const auto noted = (files / "noted").string();
  setenv("MAUVE_TRIAL_WAITS", gate.c_str(), 1);
  TrialDaemon daemon(with_a_driver(noted));
  const auto asking = daemon.client();
  unsetenv("MAUVE_TRIAL_WAITS");
  ASSERT_TRUE(eventually([&] { return TempDir::read(noted) == "+"; }));
  const auto request = protocol::make_request(1, "param.get", {{"address", "mute.read"}});
  ASSERT_TRUE(asking.send(protocol::to_line(request) + '\n'));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(gate + ".met"); }));

  daemon.process().signal(SIGTERM);
  daemon.process().signal(SIGINT);  // the second one: it does not wait for what hangs

  EXPECT_EQ(daemon.process().wait(), 1);
  EXPECT_EQ(TempDir::read(noted), "-");
  EXPECT_TRUE(daemon.says("the safe values of 1 components are written")) << daemon.errors();
}

/// mauved in a shell that has done `before`, with these options. Its log is in `place`/log.
class Begun {
 public:
  Begun(const std::string& before, const std::string& options = {})
      : mauved_({"/bin/sh", "-c",
                 before + "; exec " MAUVE_BIN_DIR "/mauved " +
                     place_.write("trial.json", kTrial).string() + " --realtime off --socket " +
                     socket() + " --plugin-dir " + whole_.plugins().string() + " " + options},
                (place_ / "log").string()) {
    EXPECT_TRUE(eventually([&] { return serves() || !mauved_.running(); })) << said();
  }

  [[nodiscard]] Process& mauved() { return mauved_; }
  [[nodiscard]] std::string socket() const { return (place_ / "sock").string(); }
  [[nodiscard]] std::string said() const { return TempDir::read(place_ / "log"); }
  [[nodiscard]] bool serves() const {
    return mauvectl(socket(), {"ping"}, (place_ / "client").string()).exit == 0;
  }

 private:
  const TrialDaemon whole_;  // its folder has the plugin
  TempDir place_;
  Process mauved_;
};

TEST(Leaving, IsNotBegunByAnInterruptOfAnotherProgram) {
  Begun begun("trap '' INT HUP");  // as a shell does for a program behind "&", and as nohup does

  begun.mauved().signal(SIGINT);
  begun.mauved().signal(SIGHUP);
  EXPECT_TRUE(begun.serves()) << begun.said();

  begun.mauved().signal(SIGTERM);
  EXPECT_EQ(begun.mauved().wait(), 0);
  EXPECT_THAT(begun.said(), testing::HasSubstr("stopping on SIGTERM"));
}

TEST(Leaving, IsBegunByTermAlsoWhereItWasIgnored) {
  Begun begun("trap '' TERM");
  begun.mauved().signal(SIGTERM);
  EXPECT_EQ(begun.mauved().wait(), 0);
}

TEST(Leaving, IsNotBegunByTheRotationOfALog) {
  const TempDir logs;
  const auto file = logs / "mauved.jsonl";
  Begun begun("true", "--log-file " + file.string());
  std::filesystem::rename(file, logs / "mauved.1");

  begun.mauved().signal(SIGHUP);
  begun.mauved().signal(SIGTERM);

  EXPECT_EQ(begun.mauved().wait(), 0);
  EXPECT_THAT(begun.said(), testing::HasSubstr("stopping on SIGTERM"));
  EXPECT_THAT(TempDir::read(logs / "mauved.1"), testing::HasSubstr("daemon_running"));
  EXPECT_THAT(TempDir::read(file), testing::HasSubstr("daemon_stopped"));
}

/// Each number of descriptors up to the first that suffices.
TEST(Leaving, IsTheWordOfAStartThatHasTooFewDescriptors) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED)
  GTEST_SKIP() << "NOT TESTED: the sanitizer needs a descriptor of its own to look at an object";
#endif
  const TrialDaemon whole;  // its folder has the file and the plugin
  const TempDir place;
  const auto socket = (place / "few").string();
  const auto file = place.write("trial.json", kTrial).string();
  bool up = false;
  for (int few = 6; !up && few < 100; ++few) {
    const auto errors = (place / std::to_string(few)).string();
    Process daemon({"/bin/sh", "-c",
                    "ulimit -n " + std::to_string(few) + "; exec " MAUVE_BIN_DIR "/mauved " + file +
                        " --realtime off --socket " + socket + " --state-dir " +
                        place.path().string() + "/state --plugin-dir " + whole.plugins().string()},
                   errors);
    ASSERT_TRUE(eventually([&] {
      up = TempDir::read(errors).find("listening on") != std::string::npos;
      return up || !daemon.running();
    }));
    if (up) break;
    EXPECT_EQ(daemon.wait(), 1) << "with " << few << " descriptors: " << TempDir::read(errors);
    EXPECT_NE(TempDir::read(errors), "") << "with " << few << " descriptors";
  }
  EXPECT_TRUE(up);
}

}  // namespace
}  // namespace mauve::test
