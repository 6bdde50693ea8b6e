// SPDX-License-Identifier: LGPL-3.0-or-later
// The service manager's watchdog: it gets a sign of life while all is well, and only then.
#include <csignal>
#include <cstdlib>

#include "kept_daemon.h"
#include "rt/thread/run_guarded.h"
#include "support/notify_socket.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// A service manager that wants to hear of mauved every second, and a resource that never returns
/// its value while a file is there.
class Heartbeats : public Generations {
 protected:
  void SetUp() override {
    setenv("WATCHDOG_USEC", "1000000", 1);
    setenv("MAUVE_TRIAL_WAITS", gate_.c_str(), 1);
    auto architecture = Json::parse(std::string(kTrial));
    architecture["resources"]["mute"] = {{"type", "trial/mute"}};
    daemon_ = std::make_unique<TrialDaemon>(architecture.dump(), options());
    static_cast<void>(daemon_->client());
  }
  void TearDown() override {
    unsetenv("WATCHDOG_USEC");
    unsetenv("MAUVE_TRIAL_WAITS");
  }
  /// Reads on until a message holds this text; how many were signs of life before.
  [[nodiscard]] int beats_until(const std::string& text) const {
    int beats = 0;
    for (;;) {
      const auto message = manager_.next();
      if (message.empty()) {
        ADD_FAILURE() << "no further notification came, not " << text;
        return beats;
      }
      if (message.find(text) != std::string::npos) {
        return beats;
      }
      beats += message.find("WATCHDOG=1") == std::string::npos ? 0 : 1;
    }
  }
  /// [control] runs the core of the resource, which hangs.
  [[nodiscard]] RawClient hang_control() const {
    static_cast<void>(place_.write("gate", "closed"));
    auto client = daemon_->client();
    const auto request = protocol::make_request(1, "param.get", {{"address", "mute.read"}});
    EXPECT_TRUE(client.send(protocol::to_line(request) + '\n'));
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(gate_ + ".met"); }));
    return client;
  }

  NotifySocket manager_;
  const std::string gate_ = (place_ / "gate").string();
  std::unique_ptr<TrialDaemon> daemon_;
};

TEST_F(Heartbeats, AreSentWhileAllIsWellAndNotWhileControlHangs) {
  EXPECT_EQ(beats_until("WATCHDOG=1"), 0);
  EXPECT_EQ(beats_until("WATCHDOG=1"), 0);

  const auto asking = hang_control();
  static_cast<void>(
      beats_until("no sign of life is sent to the watchdog: [control] does not answer"));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(beats_until("[control] does not answer"), 0);
  }

  std::filesystem::remove(gate_);
  EXPECT_EQ(beats_until("WATCHDOG=1"), 0) << "it serves again";
  EXPECT_TRUE(was_logged(*daemon_, "watchdog_silent"));
}

/// The test does the same as systemd when the time is over.
TEST_F(Heartbeats, ThatStayAwayAreFollowedByTheLastConfirmedGeneration) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer handles SIGABRT in its own way";
  ASSERT_EQ(daemon_->ask("param.set", gain(4.0))["state"], "applied");
  const auto unconfirmed =
      daemon_->ask("param.set", {{"values", {{"first.core.gain", 5.0}}}, {"confirm_within", "1h"}});
  ASSERT_EQ(unconfirmed["state"], "applied") << unconfirmed;
  const auto asking = hang_control();
  static_cast<void>(beats_until("[control] does not answer"));

  daemon_->process().signal(SIGABRT);

  EXPECT_NE(daemon_->process().wait(), 0);
  EXPECT_THAT(daemon_->errors(), HasSubstr("the safe values of 1 components are written"));
  std::filesystem::remove(gate_);
  daemon_->start();
  EXPECT_TRUE(daemon_->becomes("first.core.gain", 4.0)) << "5 was never confirmed";
}

}  // namespace
}  // namespace mauve::test
