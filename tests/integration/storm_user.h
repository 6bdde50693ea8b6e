// SPDX-License-Identifier: LGPL-3.0-or-later
/// The users of a storm. Each has a connection of its own, and reports to the oracle.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "storm_oracle.h"
#include "storm_requests.h"

namespace mauve::test {

/// Users wait here while mauved ends and starts again.
class StormGate {
 public:
  /// The users come here when they notice that their connection is gone. Returns when all are here.
  [[nodiscard]] bool close_behind(int users, std::chrono::seconds limit) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return waiting_ == users; });
  }
  void shut() { set(true, false); }
  void open() { set(false, false); }
  void end() { set(false, true); }
  [[nodiscard]] bool over() const {
    const std::lock_guard lock(mutex_);
    return over_;
  }
  /// A user has no connection.
  void pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    // mauved may be about to close the connection for another reason, or to end.
    changed_.wait_for(lock, std::chrono::milliseconds(50), [&] { return shut_ || over_; });
    changed_.wait(lock, [&] { return !shut_ || over_; });
    --waiting_;
  }

 private:
  void set(bool shut, bool over) {
    const std::lock_guard lock(mutex_);
    shut_ = shut;
    over_ = over_ || over;
    changed_.notify_all();
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool shut_ = false;
  bool over_ = false;
  int waiting_ = 0;
};

/// Counts of all users.
class StormCounts {
 public:
  void add(const std::string& what) {
    const std::lock_guard lock(mutex_);
    ++counts_[what];
  }
  /// The sum of all whose names contain this.
  [[nodiscard]] int sum(const std::string& part) const {
    const std::lock_guard lock(mutex_);
    int all = 0;
    for (const auto& [what, count] : counts_) {
      if (what.find(part) != std::string::npos) all += count;
    }
    return all;
  }
  void print() const {
    const std::lock_guard lock(mutex_);
    for (const auto& [what, count] : counts_) std::printf("%7d %s\n", count, what.c_str());
    std::fflush(stdout);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, int> counts_;
};

/// A user with its connection. It reports each request and each answer to the oracle.
class StormUser {
 public:
  static constexpr std::chrono::seconds kLongestAnswer{60};

  StormUser(const TrialDaemon& daemon, StormOracle& oracle, StormCounts& counts, std::string name)
      : daemon_(daemon), oracle_(oracle), counts_(counts), name_(std::move(name)) {}

  /// False: mauved does not listen, or has no free connection.
  [[nodiscard]] bool connect() {
    client_ = std::make_unique<RawClient>(daemon_.socket());
    const auto greeting = client_->connected() ? client_->json() : Json();
    if (greeting.is_object() && greeting.value("method", "") == "hello") return true;
    leave();
    return false;
  }
  void leave() { client_.reset(); }
  [[nodiscard]] bool connected() const { return client_ != nullptr; }

  /// The result; empty: refused, or the connection is gone.
  Json ask(const StormRequest& request) {
    if (request.install != 0) daemon_.install(request.install);
    if (request.stamp != 0) oracle_.stamped(request.stamp);
    const auto text = name_ + ": " + request.method + " " + request.params.dump().substr(0, 120);
    std::size_t order = 0;
    if (request.order) {
      order = oracle_.ask(*request.order, text);
    } else {
      oracle_.note("asked    " + text);
    }
    const auto answer = exchange(request);
    const auto outcome = outcome_of(request, answer);
    const std::string said = answer.empty() ? "lost     " + text
                                            : "answered " + name_ + ": " + request.method + " -> " +
                                                  answer.dump().substr(0, 160);
    if (request.order) {
      oracle_.answer(order, outcome, said);
    } else {
      oracle_.note(said);
    }
    const bool moves = request.method == "config.rollback" || request.method == "change.undo" ||
                       request.method == "architecture.apply";
    if (moves) oracle_.moved();
    tell(request, answer, outcome);
    return answer.value("result", Json::object());
  }
  /// A read request, which the oracle does not hear of.
  Json look(const std::string& method, const Json& params = Json::object()) {
    return exchange({method, params}).value("result", Json::object());
  }
  /// The status, judged.
  Json status() {
    const auto from = oracle_.tick();
    auto found = look("status.get");
    if (!found.empty()) oracle_.check_status(found["components"], from, oracle_.tick());
    return found;
  }

 private:
  /// Steps that only stop are carried out and saved as a stop.
  [[nodiscard]] static bool only_stops(const Json& result) {
    const auto lines = result.value("lines", Json::array());
    return !lines.empty() && std::all_of(lines.begin(), lines.end(), [](const Json& line) {
      return line.value("kind", "") == "start" && line.value("new", Json()) == false;
    });
  }
  Json exchange(const StormRequest& request) {
    if (client_ == nullptr) return Json::object();
    const auto until = std::chrono::steady_clock::now() + kLongestAnswer;
    const auto id = ++id_;
    const bool sent = client_->send(
        protocol::to_line(protocol::make_request(id, request.method, request.params)) + '\n');
    while (sent) {
      const auto left = until - std::chrono::steady_clock::now();
      const auto line = client_->json(std::chrono::ceil<std::chrono::milliseconds>(left));
      if (line.is_object() && line.contains("id") && line["id"] == id) {
        if (line.contains("result")) expect_answer_of_its_row(request.method, line["result"]);
        return line;
      }
      if (line.is_null() && !client_->ended()) {
        oracle_.violate(name_ + " waited a minute for the answer of " + request.method);
      }
      if (line.is_null()) break;
    }
    leave();
    return Json::object();
  }
  [[nodiscard]] static Outcome outcome_of(const StormRequest& request, const Json& answer) {
    if (answer.contains("error")) {
      const auto state = answer["error"].value("data", Json::object()).value("state", "");
      return state == "unchanged" ? Outcome::refused : Outcome::unknown;
    }
    const auto result = answer.value("result", Json());
    if (!result.is_object()) return Outcome::unknown;
    return request.order && !result.value("saved", false) ? Outcome::unknown : Outcome::done;
  }
  void tell(const StormRequest& request, const Json& answer, Outcome outcome) {
    const auto result = answer.value("result", Json::object());
    const auto generation = result.value("generation", std::uint64_t{0});
    if (request.stamp != 0) {
      const bool changed = result.value("changed", false);
      oracle_.stamp_answered(request.stamp, outcome, changed ? generation : 0);
    }
    std::string word = outcome == Outcome::refused ? "refused" : "unknown";
    if (outcome == Outcome::done) word = result.value("state", "done");
    counts_.add(request.method + " " + (answer.empty() ? "lost" : word));
    if (outcome != Outcome::done) return;
    const bool saved = result.value("saved", false);
    if (request.method == "change.confirm") {
      // A note says that something is left open, so that no start uses this generation yet.
      if (saved && !result.contains("notes")) oracle_.confirmed(generation);
    } else if (request.method == "change.undo") {
      oracle_.undone(result["undone"]["generations"]);
    } else if (result.value("state", "") == "applied" && result.value("changed", false) &&
               !result.contains("directly")) {
      const bool stops = request.method == "component.stop" || only_stops(result);
      const auto notes = result.value("notes", Json::array()).dump();
      const bool passed = notes.find("was saved, so the history has no generation") != notes.npos;
      oracle_.made({generation, request.method, saved, stops, passed});
    }
  }

  const TrialDaemon& daemon_;
  StormOracle& oracle_;
  StormCounts& counts_;
  const std::string name_;
  std::unique_ptr<RawClient> client_;
  int id_ = 0;
};

}  // namespace mauve::test
