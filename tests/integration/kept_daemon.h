// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauved with a state directory of the test, which outlives it.
#pragma once

#include <algorithm>
#include <sstream>

#include "trial_daemon.h"

namespace mauve::test {

/// A daemon that keeps what it does in a directory of the test.
class Generations : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path state() const { return place_ / "state"; }
  [[nodiscard]] std::vector<std::string> options() const {
    return {"--realtime", "off", "--state-dir", state().string()};
  }
  [[nodiscard]] std::filesystem::path file(const std::string& number) const {
    return state() / "generations" / (std::string(6 - number.size(), '0') + number + ".json");
  }
  [[nodiscard]] std::vector<Json> audit_lines() const {
    std::vector<Json> lines;
    std::istringstream text(TempDir::read(state() / "audit.log"));
    for (std::string line; std::getline(text, line);) {
      lines.push_back(Json::parse(line));
    }
    return lines;
  }
  /// Waits for the audit line of this method with this outcome: "applied", or the error's name.
  [[nodiscard]] Json audit_line(const std::string& method, const std::string& outcome) const {
    Json found;
    static_cast<void>(eventually([&] {
      for (const auto& line : audit_lines()) {
        const auto result = line.value("error", line.value("outcome", ""));
        if (line.value("method", "") == method && result == outcome) {
          found = line;
        }
      }
      return !found.is_null();
    }));
    return found;
  }

  TempDir place_;
};

inline Json gain(double value) {
  return {{"values", {{"first.core.gain", value}}}, {"probation", "off"}};
}

inline Json exported(TrialDaemon& daemon) { return daemon.ask("config.get")["architecture"]; }

inline Json newest(TrialDaemon& daemon) { return daemon.ask("config.history")["items"][0]; }

/// The answer of a stop. An ordinary thread that gets no processor for 2 s stops later, with its
/// safe values written.
inline bool is_stop(const Json& answer) {
  const auto state = answer.value("data", answer).value("state", "");
  return state == "applied" || state == "safe";
}

inline bool was_logged(TrialDaemon& daemon, const std::string& event) {
  return eventually([&] {
    const auto log = daemon.ask("log.tail", {{"n", 1000}});
    return std::any_of(log["records"].begin(), log["records"].end(),
                       [&](const Json& record) { return record["event"] == event; });
  });
}

inline void crash(TrialDaemon& daemon) {
  daemon.process().signal(SIGKILL);
  static_cast<void>(daemon.process().wait());
}

/// mauved ends as by a failed assertion of a plugin: a kill from outside would be no evidence.
inline void fail(TrialDaemon& daemon) {
  daemon.process().signal(SIGABRT);
  static_cast<void>(daemon.process().wait());
}

inline void end_and_start(TrialDaemon& daemon) {
  daemon.process().signal(SIGTERM);
  ASSERT_EQ(daemon.process().wait(), 0) << daemon.errors();
  daemon.start();
}

}  // namespace mauve::test
