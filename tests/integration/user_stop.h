// SPDX-License-Identifier: LGPL-3.0-or-later
/// A daemon whose user stops components.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "kept_daemon.h"
#include "rules_daemon.h"

namespace mauve::test {

inline const Json kSecondOnly = {{"components", {"second"}}};
inline const Json kEach = {{"all", true}};

inline Json steps(const Json& steps, const std::string& confirm_within = "") {
  Json params = {{"text", steps.dump()}};
  if (!confirm_within.empty()) params["confirm_within"] = confirm_within;
  return params;
}

/// The notes of an answer, in one text.
inline std::string notes_in(const Json& answer) {
  return answer.value("notes", Json::array()).dump();
}

/// Kept in a state directory of the test.
class UserStop : public Generations {
 protected:
  [[nodiscard]] std::string state_of(const std::string& name) {
    return daemon->component(name)["state"].get<std::string>();
  }
  void begin(const std::string& architecture = kTrial) {
    daemon = std::make_unique<RulesDaemon>(architecture, options());
    ASSERT_EQ(daemon->ask("change.confirm")["saved"], true) << "it has just been started";
  }
  /// In how many looks of 10 ms `second` ran a job.
  [[nodiscard]] bool stands(const std::string& name = "second") {
    const auto before = daemon->component(name)["releases"];
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    return state_of(name) == "stopped" && daemon->component(name)["releases"] == before;
  }
  /// A change that starts `second`, which stands, and waits for its confirmation.
  void start_on_probation() {
    const auto started = daemon->ask(
        "change.apply",
        steps({{{"start", "second"}}, {{"set", "first.core.gain"}, {"value", 3.0}}}, "1h"));
    ASSERT_EQ(started["state"], "applied") << started;
    EXPECT_EQ(state_of("second"), "running");
  }
  Json apply_file(const std::string& text, bool dry_run = false) {
    return daemon->ask("architecture.apply", {{"text", text}, {"dry_run", dry_run}});
  }

  std::unique_ptr<RulesDaemon> daemon;
};

}  // namespace mauve::test
