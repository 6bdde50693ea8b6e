// SPDX-License-Identifier: LGPL-3.0-or-later
/// A change costs no release, whatever the order of changes: MAUVE_CHANGES (150) of all kinds, 25
/// ms apart, in an order that MAUVE_SEED decides. The trace proves it. The rules of
/// look_oracle.h hold at any time. The requests and their outcomes stand in a file that the test
/// names.
#include <chrono>
#include <cstdio>
#include <deque>
#include <fstream>
#include <iomanip>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "changeable_systems.h"
#include "look_oracle.h"
#include "mtrace/file.h"
#include "rt/thread/thread.h"
#include "support/foreign_realtime.h"
#include "support/lost_releases.h"
#include "support/number_in.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kApart{25};
constexpr std::size_t kInFlight = 4;  ///< requests; then the next one waits
constexpr std::chrono::seconds kSlice{4};
constexpr int kKept = 12;  ///< seconds of trace, more than a slice
constexpr std::chrono::seconds kLongestAnswer{60};
constexpr std::uint64_t kProgress = 10'000;

std::int64_t now_ns() { return steady_clock::now().time_since_epoch().count(); }

/// A request, its time and its outcome.
struct Asked {
  std::uint64_t number = 0;
  Json request;
  std::int64_t sent = 0;  ///< on the monotonic clock
  std::int64_t answered = 0;
  std::string outcome;
};

/// Writes every request down before it is sent, and again with its outcome.
class ChangeLog {
 public:
  explicit ChangeLog(const std::filesystem::path& file) : file_(file) {}

  void sent(std::uint64_t number, const Json& request) {
    const std::lock_guard lock(mutex_);
    recent_.push_back({number, request, now_ns(), 0, ""});
    if (recent_.size() > kRecent) recent_.pop_front();
    file_ << Json{{"n", number}, {"request", request}}.dump() << std::endl;
  }
  void answered(std::uint64_t number, const std::string& outcome) {
    const std::lock_guard lock(mutex_);
    file_ << Json{{"n", number}, {"outcome", outcome}}.dump() << std::endl;
    for (Asked& asked : recent_) {
      if (asked.number != number) continue;
      asked.answered = now_ns();
      asked.outcome = outcome;
      ++outcomes_[asked.request["method"].get<std::string>() + " " + outcome];
    }
  }
  /// Those that were under way, or had just been answered, between these instants.
  [[nodiscard]] std::string around(std::int64_t from, std::int64_t to) const {
    constexpr std::int64_t kAfterwards = 50'000'000;
    const std::lock_guard lock(mutex_);
    std::string text;
    for (const Asked& asked : recent_) {
      const bool before = asked.answered != 0 && asked.answered + kAfterwards < from;
      if (before || asked.sent > to) continue;
      text += "\n  change " + std::to_string(asked.number) + ": " +
              asked.request.dump().substr(0, kLongestText) + " -> " +
              (asked.answered == 0 ? "under way" : asked.outcome);
    }
    return text;
  }
  [[nodiscard]] std::map<std::string, int> outcomes() const {
    const std::lock_guard lock(mutex_);
    return outcomes_;
  }

 private:
  static constexpr std::size_t kRecent = 2000;
  static constexpr std::size_t kLongestText = 200;  // the file has all of it

  mutable std::mutex mutex_;
  std::ofstream file_;
  std::deque<Asked> recent_;
  std::map<std::string, int> outcomes_;
};

/// Sends requests without waiting for their answers, and reads these.
class Changer {
 public:
  Changer(TrialDaemon& daemon, ChangeLog& log, WaitForPerson& waiting)
      : daemon_(daemon), client_(daemon.client()), log_(log), waiting_(waiting) {}

  /// False: the daemon is gone, or an answer did not come.
  [[nodiscard]] bool send(std::uint64_t number, ChangeRequest request) {
    if (!read_until(kInFlight - 1, kLongestAnswer)) return false;
    if (request.install != 0) daemon_.install(request.install);
    if (request.back >= 0) request.params["generation"] = generation_behind(request.back);
    log_.sent(number, request.to_json());
    waiting_.sent(number, request.method, request.params);
    open_.insert(number);
    const auto id = static_cast<std::int64_t>(number);
    return client_.send(
        protocol::to_line(protocol::make_request(id, request.method, request.params)) + '\n');
  }
  /// Reads what has come, until `until` at least.
  void read_for(steady_clock::time_point until) {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - steady_clock::now());
      if (left.count() <= 0) return;
      if (open_.empty()) return std::this_thread::sleep_until(until);
      read(left);
    }
  }
  [[nodiscard]] bool finish() { return read_until(0, kLongestAnswer); }

 private:
  bool read_until(std::size_t open, std::chrono::milliseconds limit) {
    const auto until = steady_clock::now() + limit;
    while (open_.size() > open && steady_clock::now() < until && daemon_.process().running()) {
      read(std::chrono::milliseconds(100));
    }
    return open_.size() <= open;
  }
  void read(std::chrono::milliseconds limit) {
    const auto answer = client_.json(limit);
    if (!answer.is_object() || !answer.contains("id")) return;
    const auto number = answer["id"].get<std::uint64_t>();
    open_.erase(number);
    const bool refused = answer.contains("error");
    waiting_.answered(number, refused ? Json::object() : answer["result"]);
    log_.answered(number, refused ? answer["error"]["data"].value("name", "?")
                                  : answer["result"].value("state", "done"));
  }
  std::int64_t generation_behind(int back) {
    const auto items = daemon_.ask("config.history", {{"n", back + 1}})["items"];
    if (!items.is_array() || items.empty()) return 1;
    return items.back()["generation"];
  }

  TrialDaemon& daemon_;
  RawClient client_;
  ChangeLog& log_;
  WaitForPerson& waiting_;
  std::set<std::uint64_t> open_;
};

/// Reads the trace in slices beside the changes, and counts what was lost.
class Witness {
 public:
  Witness(TrialDaemon& daemon, ChangeLog& log, std::filesystem::path place,
          std::vector<std::string> excused)
      : daemon_(daemon),
        log_(log),
        place_(std::move(place)),
        excused_(std::move(excused)),
        thread_([this](const std::stop_token& end) { run(end); }) {}

  /// Looks at the last slice as well.
  void finish() {
    thread_.request_stop();
    thread_.join();
    std::this_thread::sleep_for(std::chrono::seconds(1));  // what is newer is not looked at
    look();
    EXPECT_GT(slices_, 0) << "no part of the trace was read";
    EXPECT_GT(releases_.releases(), 0U);
    EXPECT_EQ(releases_.gaps(), 0) << "slices that do not meet";
  }
  void report() const {
    std::printf(
        "%lu releases; lost %ld while the machine stood still, %ld beside other real-time"
        " programs, %ld by faults of %zu components that have some\n",
        releases_.releases(), disturbed_, beside_, by_fault_, excused_.size());
    std::fflush(stdout);
  }
  /// So much time was spent beside other real-time programs, or without records, that nothing is
  /// said.
  [[nodiscard]] bool disturbed_throughout() const { return 2 * foreign_slices_ > slices_; }

 private:
  void run(const std::stop_token& end) {
    for (auto next = steady_clock::now() + kSlice; !end.stop_requested();) {
      const auto foreign = foreign_realtime(daemon_.process().id());
      if (!foreign.empty()) foreign_ = foreign;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      if (steady_clock::now() < next) continue;
      look();
      next = steady_clock::now() + kSlice;
    }
  }
  void look() {
    const auto file = (place_ / "slice.mtrace").string();
    if (daemon_.ctl({"trace", "dump", "-o", file}).exit != 0) return;
    const auto slice = ctl::mtrace::read_file(file);
    if (!slice) {
      ADD_FAILURE() << to_string(slice.error());
      return;
    }
    EXPECT_TRUE(slice->header.probed);
    const std::string foreign = std::exchange(foreign_, {});
    ++slices_;
    const bool blind = slice->header.lost != 0;  // [trace] got no processor for too long
    foreign_slices_ += foreign.empty() && !blind ? 0 : 1;
    for (const auto& lost : releases_.look(*slice)) {
      if (!blind) judge(lost, slice->header.t0, foreign);
    }
    if (blind) return;
    const auto verdict = ctl::mtrace::check(*slice);
    foreign_until_ = foreign.empty() ? foreign_until_ : slice->last_time();
    const bool beside = foreign_until_ >= slice->first_time();
    if (verdict.holds() || beside || verdict.first->time <= violated_) return;
    violated_ = slice->last_time();  // slices overlap
    ADD_FAILURE() << verdict.found
                  << " times against the model, the first: " << verdict.first->thread << " at "
                  << verdict.first->time << ": " << verdict.first->message
                  << "; the trace: " << keep("model")
                  << log_.around(verdict.first->time + slice->header.t0,
                                 verdict.first->time + slice->header.t0);
  }
  void judge(const LostReleases& lost, std::int64_t t0, const std::string& foreign) {
    const bool own_fault =
        std::find(excused_.begin(), excused_.end(), lost.component) != excused_.end();
    if (lost.disturbed || own_fault || !foreign.empty()) {
      (lost.disturbed ? disturbed_ : own_fault ? by_fault_ : beside_) += lost.count;
      return;
    }
    ADD_FAILURE() << lost.component << " lost " << lost.count << " releases after that of "
                  << lost.from << " ns, noticed at " << lost.time << "; the trace: " << keep("lost")
                  << ", flight recordings in " << place_ / "state"
                  << "; beside it" << log_.around(lost.from + t0, lost.time + t0);
  }
  std::filesystem::path keep(const std::string& word) {
    const auto kept = place_ / (word + std::to_string(++kept_) + ".mtrace");
    if (kept_ <= kMostKept) std::filesystem::copy_file(place_ / "slice.mtrace", kept);
    return kept;
  }

  static constexpr int kMostKept = 20;

  TrialDaemon& daemon_;
  ChangeLog& log_;
  const std::filesystem::path place_;
  const std::vector<std::string> excused_;
  LossWitness releases_;
  std::string foreign_;
  std::int64_t violated_ = 0;
  std::int64_t foreign_until_ = -1;
  std::int64_t disturbed_ = 0;
  std::int64_t beside_ = 0;
  std::int64_t by_fault_ = 0;
  int slices_ = 0;
  int foreign_slices_ = 0;
  int kept_ = 0;
  std::jthread thread_;
};

class ChangeCampaign : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::may_use_fifo(99)) GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here";
    std::filesystem::remove_all(place_);
    std::filesystem::create_directories(place_ / "state");
    std::filesystem::permissions(place_ / "state", std::filesystem::perms::owner_all);
  }
  void TearDown() override {
    if (!HasFailure()) std::filesystem::remove_all(place_);
  }

  void run(const ChangeableSystem& system) {
    std::printf("seed %lu; the changes stand in %s\n", seed_, (place_ / "changes").c_str());
    std::fflush(stdout);
    TrialDaemon daemon(system.file.dump(),
                       {"--realtime", "require", "--state-dir", (place_ / "state").string(),
                        "--plugin-dir", MAUVE_PLUGIN_DIR});
    ASSERT_EQ(daemon.ask("trace.start", {{"seconds", kKept}})["on"], true) << daemon.errors();
    ChangeLog log(place_ / "changes");
    Witness witness(daemon, log, place_, system.excused);
    if (!system.stopped.empty()) {
      const auto stop = daemon.ask("component.stop", {{"components", {system.stopped}}});
      ASSERT_EQ(stop["saved"], true) << stop;
    }
    WaitForPerson waiting;
    LookOracle oracle(daemon, system.stopped, &waiting);
    change(daemon, system, log, waiting);
    oracle.finish();
    witness.finish();
    witness.report();
    int applied = 0;
    for (const auto& [outcome, count] : log.outcomes()) {
      std::printf("%6d %s\n", count, outcome.c_str());
      if (outcome.ends_with(" applied")) applied += count;
    }
    EXPECT_GT(applied, 0) << "no change was in force";
    if (changes_ >= kProgress) {
      EXPECT_GT(waiting.looks(), 0) << "no generation that waits for a person was looked at";
    }
    expect_it_serves(daemon, system);
    if (witness.disturbed_throughout() && !HasFailure()) {
      GTEST_SKIP() << "NOT JUDGED: other real-time programs ran beside most of it";
    }
  }

 private:
  void change(TrialDaemon& daemon, const ChangeableSystem& system, ChangeLog& log,
              WaitForPerson& waiting) const {
    ChangeGenerator generator(system, seed_);
    Changer changer(daemon, log, waiting);
    const auto end = steady_clock::now() + std::chrono::seconds(seconds_);
    std::uint64_t number = 0;
    while (number < changes_ && steady_clock::now() < end) {
      const auto due = steady_clock::now() + kApart;
      ASSERT_TRUE(changer.send(++number, generator.next()))
          << "change " << number << ", seed " << seed_ << daemon.errors();
      changer.read_for(due);
      if (number % kProgress == 0) say(number);
    }
    say(number);
    EXPECT_TRUE(changer.finish()) << "not all are answered" << daemon.errors();
  }
  static void say(std::uint64_t number) {
    std::printf("%lu changes\n", number);
    std::fflush(stdout);
  }
  /// The file of the beginning can be applied, and all of it runs.
  static void expect_it_serves(TrialDaemon& daemon, const ChangeableSystem& system) {
    ASSERT_TRUE(daemon.process().running()) << daemon.errors();
    static_cast<void>(daemon.ask("lock.set", {{"lock", "none"}}));
    daemon.install(1);
    static_cast<void>(daemon.ask("change.confirm"));
    release_quarantine(daemon, system);
    static_cast<void>(daemon.ask("plugin.reload",
                                 {{"plugin", "trial"}, {"state", "drop"}, {"probation", "off"}}));
    const auto applied =
        daemon.ask("architecture.apply",
                   {{"text", system.file.dump()}, {"state", "drop"}, {"probation", "off"}});
    EXPECT_EQ(applied.value("state", ""), "applied") << applied;
    Json all = Json::array();
    for (const auto& [name, component] : system.file["components"].items()) all.push_back(name);
    static_cast<void>(daemon.ask("component.start", {{"components", all}}));
    auto status = daemon.ask("status.get");
    ASSERT_EQ(status["components"].size(), all.size()) << status;
    for (const auto& row : status["components"]) {
      EXPECT_EQ(row["state"], "running") << row;
    }
  }

  /// Also a sound core may be in quarantine: a machine that stood still for longer than the
  /// watchdog of its component ended its job. No other failure is one of its own.
  static void release_quarantine(TrialDaemon& daemon, const ChangeableSystem& system) {
    const auto quarantined = daemon.ask("quarantine.list");
    for (const auto& row : quarantined["cores"]) {
      const std::string core = row["core"];
      const std::string reason = row["reason"];
      std::printf("in quarantine: %s, %s\n", core.c_str(), reason.c_str());
      if (system.sound.contains(core)) {
        EXPECT_THAT(reason, testing::StartsWith("hung: its job ran longer than"));
      }
      static_cast<void>(daemon.ask("quarantine.release", {{"core", core}}));
    }
  }

  const std::uint64_t seed_ = number_in("MAUVE_SEED", 1);
  const std::uint64_t changes_ = number_in("MAUVE_CHANGES", 150);
  const std::uint64_t seconds_ = number_in("MAUVE_CAMPAIGN_SECONDS", 36'000);
  const std::filesystem::path place_ =
      std::filesystem::path(testing::TempDir()) /
      ("mauve-changes-" + std::to_string(seed_) + "-" +
       testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ChangeCampaign, CostsTheTrialComponentsNoRelease) { run(trial_system()); }

TEST_F(ChangeCampaign, CostsTheRoverNoRelease) { run(rover_system(MAUVE_SOURCE_DIR "/etc")); }

}  // namespace
}  // namespace mauve::test
