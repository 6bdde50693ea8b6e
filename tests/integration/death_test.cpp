// SPDX-License-Identifier: LGPL-3.0-or-later
// A death of mauved is evidence against nobody. All that happens after a deadly signal is a
// consequence of it: no core is to blame, nothing is rolled back, and nothing is saved.
// MAUVE_DEATHS: how many (10), in an order that MAUVE_SEED decides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "support/daemon_process.h"
#include "support/number_in.h"

namespace mauve::test {
namespace {

using Json = nlohmann::json;

constexpr std::array kDeadly{SIGSEGV, SIGABRT, SIGBUS,  SIGFPE,  SIGILL, SIGXCPU,
                             SIGUSR2, SIGSYS,  SIGALRM, SIGTRAP, SIGQUIT};
constexpr const char* kOther = "guidance/finite_time";

/// The act of mauved under which the signal comes.
enum class Phase { probation, change, undo, apply, end };
constexpr std::array kPhases{Phase::probation, Phase::change, Phase::undo, Phase::apply,
                             Phase::end};
constexpr std::array kNames{"probation", "change", "undo", "apply", "end"};

class ADeath : public testing::Test {
 protected:
  [[nodiscard]] DaemonProcess start() const {
    return DaemonProcess(MAUVE_ETC_DIR "/yard.json", {"--realtime", "off", "--guardian", "off",
                                                      "--state-dir", state().string()});
  }
  [[nodiscard]] std::filesystem::path state() const { return place_ / "state"; }

  /// mauved in a phase dies of a signal, which comes at some instant of it.
  void let_die(Phase phase, int signal, std::mt19937& chance) {
    DaemonProcess daemon = start();
    ASSERT_TRUE(daemon.up());
    if (phase == Phase::probation || phase == Phase::undo) {
      ASSERT_EQ(swap(daemon)["state"], "applied");
    }
    const auto asked = ask(daemon, phase);
    if (phase == Phase::end) daemon.process().signal(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(chance() % 40));
    daemon.process().signal(signal);
    const int ended = daemon.process().wait();
    EXPECT_TRUE(ended == 128 + signal || phase == Phase::end) << "it ended with " << ended;
  }
  /// The next start blames nobody, and accepts the core.
  void blames_nobody() {
    DaemonProcess daemon = start();
    ASSERT_TRUE(daemon.up()) << daemon.errors();
    EXPECT_EQ(daemon.ask({"quarantine"})["cores"], Json::array());
    const Json history = daemon.ask({"history"})["items"];
    EXPECT_FALSE(history.empty());
    for (const Json& one : history) EXPECT_NE(one.value("command", ""), "rolled_back") << one;
    EXPECT_EQ(swap(daemon)["state"], "applied");
    daemon.process().signal(SIGTERM);
    EXPECT_EQ(daemon.process().wait(), 0);
  }

 private:
  static Json swap(DaemonProcess& daemon) { return daemon.ask({"swap-core", "control", kOther}); }

  /// A client whose answer is not waited for.
  [[nodiscard]] std::unique_ptr<Process> ask(DaemonProcess& daemon, Phase phase) const {
    std::vector<std::string> words;
    if (phase == Phase::change) words = {"swap-core", "control", kOther};
    if (phase == Phase::undo) words = {"undo"};
    if (phase == Phase::apply) {
      words = {"apply", place_.write("next.json", with_another_core()).string()};
    }
    if (words.empty()) return nullptr;
    return std::make_unique<Process>(daemon.client_words(words));
  }
  /// The file with another core of `control`.
  static std::string with_another_core() {
    std::string text = TempDir::read(MAUVE_ETC_DIR "/yard.json");
    const std::string core = "guidance/potential_field";
    const auto at = text.find('"' + core + '"');
    if (at != std::string::npos) text.replace(at + 1, core.size(), kOther);
    return text;
  }

  TempDir place_;
};

TEST_F(ADeath, IsEvidenceAgainstNobody) {
  std::vector<std::pair<Phase, int>> all;
  for (const Phase phase : kPhases) {
    for (const int signal : kDeadly) all.emplace_back(phase, signal);
  }
  std::mt19937 chance(static_cast<unsigned>(number_in("MAUVE_SEED", 1)));
  std::shuffle(all.begin(), all.end(), chance);
  const auto wanted = static_cast<std::size_t>(number_in("MAUVE_DEATHS", 10));
  for (std::size_t i = 0; i < wanted && !HasFailure(); ++i) {
    const auto [phase, signal] = all[i % all.size()];
    SCOPED_TRACE(std::string("signal ") + std::to_string(signal) + " in phase " +
                 kNames[static_cast<std::size_t>(phase)]);
    let_die(phase, signal, chance);
    blames_nobody();
    std::filesystem::remove_all(state());
  }
}

}  // namespace
}  // namespace mauve::test
