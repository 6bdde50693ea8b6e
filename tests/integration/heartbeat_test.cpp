// SPDX-License-Identifier: LGPL-3.0-or-later
// The service manager's watchdog: it gets a sign of life while all is well, and only then.
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

#include "kept_daemon.h"
#include "rt/thread/run_guarded.h"
#include "support/notify_socket.h"

namespace mauve::test {
namespace {

/// A service manager that wants to hear of mauved every second, and a resource that never returns
/// its value while a file is there.
class Heartbeats : public Generations {
 protected:
  void SetUp() override {
    setenv("WATCHDOG_USEC", "1000000", 1);
    setenv("MAUVE_TRIAL_WAITS", gate_.c_str(), 1);
    auto architecture = Json::parse(std::string(kTrial));
    architecture["resources"]["mute"] = {{"type", "trial/mute"}};
    architecture["rules"] = {{{"name", "never"},
                              {"when", "second.core.input > 1000000"},
                              {"do", {{{"stop", "second"}}}}}};
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

/// The process of the test stops these threads of mauved, and lets them go on with resume().
class StoppedThreads {
 public:
  /// Where the thread waits: it then holds no lock that another thread needs. False: this machine
  /// does not permit it.
  [[nodiscard]] bool stop(const std::filesystem::path& task) {
    const pid_t thread = std::stoi(task.filename());
    const auto waits = std::to_string(SYS_futex) + " ";
    for (;;) {
      if (ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0) return false;
      EXPECT_EQ(ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr), 0);
      int status = 0;
      EXPECT_EQ(waitpid(thread, &status, __WALL), thread);
      const auto call = TempDir::read(task / "syscall");
      if (call.empty() || call.starts_with(waits)) {
        stopped_.push_back(thread);
        return true;
      }
      EXPECT_EQ(ptrace(PTRACE_DETACH, thread, nullptr, nullptr), 0);
    }
  }
  void resume() {
    for (const auto thread : std::exchange(stopped_, {})) {
      EXPECT_EQ(ptrace(PTRACE_DETACH, thread, nullptr, nullptr), 0);
    }
  }
  ~StoppedThreads() { resume(); }

 private:
  std::vector<pid_t> stopped_;
};

/// [control] and [io] are asked. [link] waits for the guardian, which is supervised itself, and
/// [reaper] and [last] for the end of the process (docs/concepts/threads.md).
bool has_no_pulse(const std::string& name) {
  static const std::set<std::string> names = {"control", "io", "link", "last", "reaper"};
  return names.contains(name);
}

TEST_F(Heartbeats, AreNotSentWhileAnyThreadThatHasToTurnStands) {
  EXPECT_EQ(beats_until("WATCHDOG=1"), 0);
  const std::string tasks = "/proc/" + std::to_string(daemon_->process().id()) + "/task";
  StoppedThreads threads;
  std::set<std::string> names;
  for (const auto& task : std::filesystem::directory_iterator(tasks)) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm") >> std::ws, name);
    const std::string ours = "mauve-";
    if (!name.starts_with(ours) || has_no_pulse(name.substr(ours.size()))) continue;
    if (!threads.stop(task.path())) {
      GTEST_SKIP() << "ptrace is not permitted here, so no thread was stopped: " << strerror(errno);
    }
    names.insert(name.substr(ours.size()));
  }
  for (const auto* known :
       {"rules", "guard", "factory", "disk", "health", "stop", "log", "trace", "watch"}) {
    EXPECT_TRUE(names.contains(known)) << known;
  }
  // Each text names all threads that stand by then, in no order.
  std::string text;
  const auto misses = [&](const std::string& name) {
    return text.find("[" + name + "] has not turned for") == std::string::npos;
  };
  for (int messages = 0; messages < 200 && std::ranges::any_of(names, misses); ++messages) {
    text = manager_.next();
  }
  for (const auto& name : names) {
    EXPECT_FALSE(misses(name)) << name << " stands, and is not named in: " << text;
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(beats_until("has not turned for"), 0);
  }

  threads.resume();

  static_cast<void>(beats_until("WATCHDOG=1"));
  EXPECT_EQ(beats_until("WATCHDOG=1"), 0) << "all turn again";
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
  EXPECT_TRUE(daemon_->says("the safe values of 1 components are written")) << daemon_->errors();
  std::filesystem::remove(gate_);
  daemon_->start();
  EXPECT_TRUE(daemon_->becomes("first.core.gain", 4.0)) << "5 was never confirmed";
}

}  // namespace
}  // namespace mauve::test
