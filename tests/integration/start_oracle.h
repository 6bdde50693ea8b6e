// SPDX-License-Identifier: LGPL-3.0-or-later
/// A start would accept what runs. Beside all changes, the running system is asked for as a file,
/// again and again, and mauved finds no error in that file.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "trial_daemon.h"

namespace mauve::test {

class StartOracle {
 public:
  explicit StartOracle(TrialDaemon& daemon)
      : client_(daemon.client()), thread_([this](const std::stop_token& end) { run(end); }) {}

  /// Looks at the system once more, after the last change.
  void finish() {
    thread_.request_stop();
    thread_.join();
    const auto before = looks_;
    for (int i = 0; i < kTries && looks_ == before; ++i) {
      look();
      std::this_thread::sleep_for(kApart);
    }
    std::printf("%d looks at whether what runs can be started\n", looks_);
    EXPECT_GT(looks_, before) << "no look was answered after the last change";
  }

 private:
  using Json = protocol::Json;
  static constexpr int kTries = 200;
  static constexpr std::chrono::milliseconds kApart{100};

  void run(const std::stop_token& end) {
    while (!end.stop_requested() && !testing::Test::HasFailure()) {
      look();
      std::this_thread::sleep_for(kApart);
    }
  }
  /// An answer that is refused, since too many are asked for, says nothing.
  void look() {
    const auto running = client_.ask("config.get", Json::object());
    if (!running.contains("result")) return;
    const std::string text = running["result"]["architecture"].dump();
    const auto checked = client_.ask("config.check", {{"text", text}});
    if (!checked.contains("result")) return;
    ++looks_;
    const Json& errors = checked["result"]["errors"];
    EXPECT_TRUE(errors.empty()) << errors << "\nin " << text;
  }

  RawClient client_;
  int looks_ = 0;
  std::jthread thread_;
};

}  // namespace mauve::test
