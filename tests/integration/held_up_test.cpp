// SPDX-License-Identifier: LGPL-3.0-or-later
// Stops while [control] is held up, by code of a plugin that does not return there.
#include <csignal>
#include <cstdlib>

#include "kept_daemon.h"
#include "support/guarded.h"
#include "support/outlet.h"

namespace mauve::test {
namespace {

/// `second` notes the sign of what `first` writes, as a driver writes to its device; `mute` does
/// not return its value while a file is there, and whoever asks for it holds [control] so long.
class HeldUp : public Generations {
 protected:
  void SetUp() override {
    setenv("MAUVE_TRIAL_WAITS", gate_.c_str(), 1);
    start(architecture(), options());
  }
  [[nodiscard]] Json architecture() const {
    auto architecture = Json::parse(std::string(kTrial));
    architecture["resources"]["mute"] = {{"type", "trial/mute"}};
    architecture["components"]["second"]["core"] = "trial/noting";
    architecture["components"]["second"]["properties"]["core.file"] = noted_;
    return architecture;
  }
  void start(const Json& architecture, const std::vector<std::string>& options) {
    daemon_ = std::make_unique<TrialDaemon>(architecture.dump(), options);
    asking_ = std::make_unique<RawClient>(daemon_->client());
    ASSERT_TRUE(is_noted("+")) << daemon_->errors();
  }
  void TearDown() override {
    std::filesystem::remove(gate_);
    unsetenv("MAUVE_TRIAL_WAITS");
  }
  void hold_control() {
    static_cast<void>(place_.write("gate", "closed"));
    const auto request = protocol::make_request(1, "param.get", {{"address", "mute.read"}});
    ASSERT_TRUE(asking_->send(protocol::to_line(request) + '\n'));
    ASSERT_TRUE(eventually([this] { return std::filesystem::exists(gate_ + ".met"); }));
  }
  [[nodiscard]] bool is_noted(const std::string& sign) const {
    return eventually([&] { return TempDir::read(noted_) == sign; });
  }
  [[nodiscard]] std::string state_of(const std::string& name) {
    return daemon_->component(name)["state"];
  }

  const std::string gate_ = (place_ / "gate").string();
  const std::string noted_ = (place_ / "noted").string();
  std::unique_ptr<TrialDaemon> daemon_;
  std::unique_ptr<RawClient> asking_;
};

TEST_F(HeldUp, AStopIsCarriedOutAndAnsweredAllTheSame) {
  ASSERT_NO_FATAL_FAILURE(hold_control());

  const auto stopped = daemon_->ask("component.stop", {{"components", {"first"}}});

  ASSERT_TRUE(stopped.contains("state")) << stopped;
  EXPECT_EQ(stopped["state"], "applied") << stopped;
  EXPECT_EQ(stopped["directly"], true) << stopped;
  ASSERT_EQ(stopped["warnings"].size(), 1U) << "other commands wait, and a warning says so";
  ASSERT_EQ(stopped["components"].size(), 1U);
  EXPECT_EQ(stopped["components"][0]["name"], "first");
  EXPECT_TRUE(is_noted("-")) << "the driver, which was not stopped, acts on the safe value";
}

TEST_F(HeldUp, AStopIsInTheBooksAsSoonAsControlGoesOn) {
  ASSERT_NO_FATAL_FAILURE(hold_control());
  const auto stopped =
      daemon_->ask("component.stop", {{"components", {"first"}}, {"reason", "smoke"}});
  ASSERT_EQ(stopped["state"], "applied") << stopped;

  std::filesystem::remove(gate_);

  EXPECT_TRUE(eventually([this] { return state_of("first") == "stopped"; }));
  EXPECT_EQ(state_of("second"), "running");
  const auto line = audit_line("component.stop", "applied");
  EXPECT_EQ(line["reason"], "smoke") << line;
  EXPECT_EQ(line["generation"], stopped["generation"]);
  EXPECT_TRUE(was_logged(*daemon_, "stopped_directly"));
  EXPECT_EQ(daemon_->ask("component.start", {{"components", {"first"}}})["state"], "applied");
  EXPECT_EQ(state_of("first"), "running");
  EXPECT_TRUE(is_noted("+"));
  EXPECT_EQ(daemon_->ask("param.set", gain(3.0))["state"], "applied") << "and changes are served";
}

TEST_F(HeldUp, AStopOfAllIsCarriedOutWritersFirst) {
  ASSERT_NO_FATAL_FAILURE(hold_control());

  const auto stopped = daemon_->ask("component.stop", {{"all", true}});

  EXPECT_EQ(stopped["state"], "applied") << stopped;
  EXPECT_EQ(stopped["components"].size(), 2U);
  EXPECT_EQ(TempDir::read(noted_), "-") << "the driver acted on the safe value before it parked";
  std::filesystem::remove(gate_);
  EXPECT_EQ(state_of("first"), "stopped");
  EXPECT_EQ(state_of("second"), "stopped");
  const auto started = daemon_->ask("component.start", {{"components", {"first", "second"}}});
  EXPECT_EQ(started["state"], "applied") << started;
  EXPECT_EQ(state_of("second"), "running");
}

TEST_F(HeldUp, AStartThatWasAskedForBeforeTheStopStartsNothing) {
  ASSERT_EQ(daemon_->ask("component.stop", {{"components", {"first"}}})["state"], "applied");
  ASSERT_NO_FATAL_FAILURE(hold_control());
  auto starting = daemon_->client();
  const auto start = protocol::make_request(7, "component.start", {{"components", {"first"}}});
  ASSERT_TRUE(starting.send(protocol::to_line(start) + '\n'));
  ASSERT_EQ(starting.ask("ping")["result"]["pong"], true) << "it has come";
  const auto stopped = daemon_->ask("component.stop", {{"components", {"first"}}});
  ASSERT_EQ(stopped["state"], "unchanged") << stopped;

  std::filesystem::remove(gate_);

  EXPECT_EQ(starting.json()["error"]["data"]["name"], "conflict");
  EXPECT_EQ(state_of("first"), "stopped");
  EXPECT_EQ(daemon_->ask("component.start", {{"components", {"first"}}})["state"], "applied");
}

TEST_F(HeldUp, AStopThatControlWillRefuseIsNotCarriedOut) {
  ASSERT_NO_FATAL_FAILURE(hold_control());
  std::vector<RawClient> clients;
  const std::vector<Json> refused = {{{"components", {"first", "nobody"}}},
                                     {{"components", {"first"}}, {"if_generation", 4711}},
                                     {{"components", {"first"}}, {"all", true}}};
  for (const auto& params : refused) {
    clients.push_back(daemon_->client());
    const auto request = protocol::make_request(7, "component.stop", params);
    ASSERT_TRUE(clients.back().send(protocol::to_line(request) + '\n'));
  }
  const auto stopped = daemon_->ask("component.stop", {{"components", {"second"}}});
  ASSERT_EQ(stopped["state"], "applied")
      << "later than those before, which were looked at: " << stopped;

  std::filesystem::remove(gate_);

  for (auto& client : clients) EXPECT_TRUE(client.json().contains("error"));
  EXPECT_EQ(state_of("first"), "running");
}

TEST_F(HeldUp, TheStopForALostGuardianIsCarriedOut) {
  daemon_.reset();
  Outlet base;  // never reports: it stands, and is held all the same
  auto guarded = architecture();
  const Json more = guarded_architecture(base.path());
  for (const auto& plugin : more["plugins"]) guarded["plugins"].push_back(plugin);
  guarded["resources"].update(more["resources"]);
  guarded["components"].update(more["components"]);
  auto how = options();
  how.insert(how.end(), {"--guardian", "require", "--plugin-dir", MAUVE_PLUGIN_DIR});
  ASSERT_NO_FATAL_FAILURE(start(guarded, how));
  const auto guardian = daemon_->ask("status.get")["guardian"];
  ASSERT_TRUE(guardian.is_object() && guardian["process"].is_number()) << guardian;
  ASSERT_NO_FATAL_FAILURE(hold_control());

  kill(guardian["process"].get<pid_t>(), SIGKILL);

  EXPECT_TRUE(is_noted("-")) << "although [control] is held up";
  std::filesystem::remove(gate_);
  EXPECT_TRUE(eventually([this] { return state_of("first") == "stopped"; })) << daemon_->errors();
  EXPECT_EQ(state_of("base"), "stopped");
}

TEST_F(HeldUp, TheEndOfMauvedMakesTheOutputsSafeAtOnce) {
  ASSERT_NO_FATAL_FAILURE(hold_control());

  daemon_->process().signal(SIGTERM);

  EXPECT_TRUE(is_noted("-")) << "long before the end by force";
  EXPECT_TRUE(daemon_->process().running());
  std::filesystem::remove(gate_);
  EXPECT_EQ(daemon_->process().wait(), 0) << daemon_->errors();
}

}  // namespace
}  // namespace mauve::test
