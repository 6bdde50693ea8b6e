// SPDX-License-Identifier: LGPL-3.0-or-later
/// Rules that hold at every moment beside all changes. A start would accept what runs. A component
/// that a user stopped stands. Nothing that waits for a person is confirmed by itself.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "trial_daemon.h"

namespace mauve::test {

/// The generations that wait for a person. Requests have numbers in the order in which they are
/// sent.
class WaitForPerson {
 public:
  using Json = protocol::Json;

  void sent(std::uint64_t number, const std::string& method, const Json& params) {
    const std::lock_guard lock(mutex_);
    if (params.contains("confirm_within")) asked_.insert(number);
    if (method != "change.confirm") return;
    confirm_ = number;  // it may confirm all before it
    waiting_.clear();
  }
  void answered(std::uint64_t number, const Json& result) {
    const std::lock_guard lock(mutex_);
    const bool waits = asked_.erase(number) > 0 && number > confirm_;
    if (waits && result.value("state", "") == "applied")
      waiting_.insert(result["generation"].get<std::uint64_t>());
  }
  void check(const Json& history) {
    const std::lock_guard lock(mutex_);
    for (const auto& item : history) {
      const bool waits = waiting_.contains(item["generation"].get<std::uint64_t>());
      looks_ += waits ? 1 : 0;
      EXPECT_FALSE(waits && item.value("mark", "") == "confirmed")
          << "nobody has confirmed " << item;
    }
  }
  [[nodiscard]] int looks() const {
    const std::lock_guard lock(mutex_);
    return looks_;
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::uint64_t> asked_;
  std::set<std::uint64_t> waiting_;
  std::uint64_t confirm_ = 0;
  int looks_ = 0;
};

class LookOracle {
 public:
  /// `stopped`: a component that a user has stopped and nobody starts; empty: there is none.
  LookOracle(TrialDaemon& daemon, std::string stopped, WaitForPerson* waiting = nullptr)
      : client_(daemon.client()),
        stopped_(std::move(stopped)),
        waiting_(waiting),
        thread_([this](const std::stop_token& end) { run(end); }) {}

  /// Looks at the system once more, after the last change.
  void finish() {
    thread_.request_stop();
    thread_.join();
    const auto before = looks_;
    for (int i = 0; i < kTries && looks_ == before; ++i) {
      look();
      std::this_thread::sleep_for(kApart);
    }
    std::printf("%d looks at whether what runs can be started, %d at what stands\n", looks_,
                stood_);
    if (waiting_ != nullptr) {
      std::printf("%d looks at generations that wait for a person\n", waiting_->looks());
    }
    EXPECT_GT(looks_, before) << "no look was answered after the last change";
    EXPECT_TRUE(stopped_.empty() || stood_ > 0) << "what a user stopped was never looked at";
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
    look_at_start();
    look_at_stop();
    const auto history = client_.ask("config.history", {{"n", 100}});
    if (waiting_ != nullptr && history.contains("result")) {
      waiting_->check(history["result"]["items"]);
    }
  }
  void look_at_start() {
    const auto running = client_.ask("config.get", Json::object());
    if (!running.contains("result")) return;
    const std::string text = running["result"]["architecture"].dump();
    const auto checked = client_.ask("config.check", {{"text", text}});
    if (!checked.contains("result")) return;
    ++looks_;
    const Json& errors = checked["result"]["errors"];
    EXPECT_TRUE(errors.empty()) << errors << "\nin " << text;
  }
  /// A file without it may have removed it.
  void look_at_stop() {
    const auto status = client_.ask("status.get", Json::object());
    if (stopped_.empty() || !status.contains("result")) return;
    for (const auto& row : status["result"]["components"]) {
      if (row["name"] != stopped_) continue;
      ++stood_;
      EXPECT_NE(row["state"], "running") << "a user has stopped it: " << row;
      EXPECT_TRUE(row.contains("stopped_by")) << row;
    }
  }

  RawClient client_;
  const std::string stopped_;
  WaitForPerson* const waiting_;
  int looks_ = 0;
  int stood_ = 0;
  std::jthread thread_;
};

}  // namespace mauve::test
