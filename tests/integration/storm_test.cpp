// SPDX-License-Identifier: LGPL-3.0-or-later
/// The promises of mauved about stops, generations and restarts hold in a storm. For
/// MAUVE_STORM_SECONDS there are two operators, an admin, viewers, rules, requests and faults at
/// once, and every now and then an end of mauved. MAUVE_SEED decides the order.
#include <cstdio>
#include <fstream>
#include <functional>
#include <thread>

#include "kept_daemon.h"
#include "storm_user.h"
#include "support/number_in.h"

namespace mauve::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Without what stops and failures change: another core takes over from one that fails at once.
Json lasting_part(Json architecture) {
  for (auto& [name, component] : architecture["components"].items()) {
    component.erase("start");
    if (may_fail(name)) component = name;
  }
  return architecture;
}

/// How a run of mauved ended, and how the next one begins.
struct End {
  int signal = SIGKILL;
  bool goes_on = false;  ///< after an orderly end: with the newest confirmed generation
  bool forced = false;   ///< an orderly end took too long
  bool fresh = false;    ///< the next start is one with --fresh
  Json last = {};        ///< the components in the last status before it
  Moment looked = 0;     ///< the time of that status
  std::map<std::uint64_t, Saved> saved = {};

  [[nodiscard]] bool recovers() const { return !fresh && (signal != SIGTERM || goes_on || forced); }
  [[nodiscard]] std::string words() const {
    const std::string name = signal == SIGKILL   ? "SIGKILL"
                             : signal == SIGTERM ? "SIGTERM"
                                                 : "SIGABRT";
    return "ends by " + name + (goes_on ? ", then `continue`" : "") +
           (fresh ? ", then --fresh" : "");
  }
};

class Storm : public Generations {
 protected:
  static constexpr int kUsers = 5;
  static constexpr int kMostCrashes = 3;  ///< in a row

  void SetUp() override {
    std::filesystem::create_directory(signs_);
    file_ = stormy(signs_.string());
    auto words = options();
    words.insert(words.end(), {"--flight-recorder", "off"});
    daemon_ = std::make_unique<TrialDaemon>(file_.dump(), words);
    me_ = std::make_unique<StormUser>(*daemon_, oracle_, counts_, "observer");
    boot_ = daemon_->ask("version")["boot"];
    file_ = exported(*daemon_);
    ASSERT_TRUE(file_.is_object()) << daemon_->errors();
    ASSERT_TRUE(me_->connect());
  }

  void rage() {
    std::vector<std::thread> users;
    users.emplace_back([this] { operate("operator 1", 1); });
    users.emplace_back([this] { operate("operator 2", 2); });
    users.emplace_back([this] { administrate(); });
    users.emplace_back([this] { view("viewer 1", 4); });
    users.emplace_back([this] { view("viewer 2", 5); });
    const auto end = steady_clock::now() + std::chrono::seconds(seconds_);
    while (steady_clock::now() < end && oracle_.violations() == 0 && !HasFatalFailure()) {
      watch(milliseconds(apart_ * (500 + random_() % 1000)));
      if (oracle_.violations() == 0) end_and_begin();
    }
    gate_.end();
    for (auto& user : users) user.join();
    if (oracle_.violations() != 0) std::cout << "in " << place_.path() << "\n";
  }
  void report() const {
    counts_.print();
    for (const auto& [method, count] : oracle_.missing()) {
      std::printf("%7d generations of %s not in the history\n", count, method.c_str());
    }
    std::printf("%7lu looks at a component under a stop\n%7d violations, seed %lu, %lu s\n",
                oracle_.stood(), oracle_.violations(), seed_, seconds_);
    constexpr std::uint64_t kCampaign = 300;
    EXPECT_GT(counts_.sum("ends by "), 0);
    EXPECT_GT(counts_.sum(" applied"), 0);
    EXPECT_TRUE(seconds_ < kCampaign || oracle_.stood() > 0) << "no stop was looked at";
  }

  const std::uint64_t seed_ = number_in("MAUVE_SEED", 1);
  const std::uint64_t seconds_ = number_in("MAUVE_STORM_SECONDS", 10);
  /// Between two ends, in seconds.
  const std::uint64_t apart_ = std::clamp<std::uint64_t>(seconds_ / 15, 2, 20);
  StormOracle oracle_{seed_};

 private:
  // The users.

  /// Does something again and again, with a connection.
  void again(StormUser& user, const std::function<void()>& act) {
    while (!gate_.over()) {
      if (user.connected() || user.connect()) {
        act();
      } else {
        gate_.pass();
      }
    }
  }
  void operate(const std::string& name, std::uint64_t place) {
    StormUser user(*daemon_, oracle_, counts_, name);
    StormRequests requests(file_, seed_ * 100 + place, static_cast<std::int64_t>(place));
    again(user, [&] {
      static_cast<void>(user.ask(requests.of_operator()));
      std::this_thread::sleep_for(milliseconds(requests.below(40)));
    });
  }
  void administrate() {
    StormUser user(*daemon_, oracle_, counts_, "admin");
    StormRequests requests(file_, seed_ * 100 + 3, 3);
    again(user, [&] {
      std::vector<std::uint64_t> confirmed;
      for (const auto& row :
           user.look("config.history", {{"n", 30}}).value("items", Json::array())) {
        if (row["mark"] == "confirmed") confirmed.push_back(row["generation"]);
      }
      static_cast<void>(user.ask(requests.of_admin(confirmed)));
      std::this_thread::sleep_for(milliseconds(requests.below(150)));
    });
  }
  void view(const std::string& name, std::uint64_t place) {
    StormUser user(*daemon_, oracle_, counts_, name);
    StormRequests requests(file_, seed_ * 100 + place, 0);
    again(user, [&] {
      static_cast<void>(
          user.look("watch.subscribe", {{"addresses", {"signal.read", "c.core.count"}}}));
      for (auto looks = requests.below(5); looks > 0; --looks) {
        static_cast<void>(user.status());
        static_cast<void>(user.look("component.why", {{"component", "weak"}}));
        counts_.add("visits of viewers");
      }
      std::this_thread::sleep_for(milliseconds(requests.below(30)));
      user.leave();
    });
  }
  /// Looks on from outside, and lets cores fail.
  void watch(milliseconds time) {
    const auto until = steady_clock::now() + time;
    for (int turn = 0; steady_clock::now() < until && oracle_.violations() == 0; ++turn) {
      if (!daemon_->process().running()) {
        return oracle_.violate("mauved has ended by itself: " + end_of_log());
      }
      static_cast<void>(me_->status());
      if (turn % 5 == 0) look_at_content(false);
      if (turn % 10 == 0) oracle_.check_history(me_->look("config.history")["items"]);
      if (random_() % 20 == 0) toggle(random_() % 2 == 0 ? "weak" : "frail");
      std::this_thread::sleep_for(milliseconds(40));
    }
  }
  void look_at_content(bool after_restart) {
    const auto from = oracle_.tick();
    const auto content = me_->look("config.get");
    if (!content.empty()) {
      oracle_.check_content(content["architecture"], from, after_restart);
    }
  }
  /// The sign at which the cores of a component fail comes or goes; most are gone soon.
  void toggle(const std::string& component) {
    const auto sign = signs_ / component;
    if (std::filesystem::remove(sign) || random_() % 3 != 0) return;
    counts_.add("signs of faults");
    std::ofstream(sign) << "fail";
  }

  // The ends.

  void end_and_begin() {
    End end;
    const auto kind = random_() % 10;
    end.signal = kind < 4 ? SIGKILL : kind < 7 ? SIGTERM : SIGABRT;
    end.goes_on = end.signal == SIGTERM && random_() % 2 == 0;
    end.fresh = random_() % 12 == 0;
    // Otherwise hardly a generation could be started.
    if (random_() % 8 != 0) {
      static_cast<void>(me_->ask({"quarantine.release", {{"core", "trial/brittle"}}}));
    }
    end.looked = oracle_.tick();
    end.last = me_->status().value("components", Json::array());
    gate_.shut();
    // Now and then a run crashes right after its start, again and again.
    const bool loops = end.signal == SIGABRT && random_() % 4 == 0;
    for (int left = loops ? 5 : 1; left > 0 && oracle_.violations() == 0; --left) {
      end_once(end);
      if (oracle_.violations() == 0) begin(end);
      end.last = Json::array();
    }
    gate_.open();
  }
  void end_once(End& end) {
    counts_.add(end.words());
    oracle_.note("=== " + end.words());
    crashes_ = end.signal == SIGTERM ? 0 : crashes_ + (end.signal == SIGABRT ? 1 : 0);
    daemon_->process().signal(end.signal);
    const int code = daemon_->process().wait();
    if (end.signal == SIGTERM && code != 0) {
      // On a machine that stands still the end is one by force, and no crash either.
      end.forced = end_of_log().find("it takes too long") != std::string::npos;
      counts_.add("orderly ends by force");
      if (!end.forced) {
        oracle_.violate("an orderly end has the exit code " + std::to_string(code) + end_of_log());
      }
    }
    if (!gate_.close_behind(kUsers, 2 * StormUser::kLongestAnswer)) {
      return oracle_.violate("the connection of a user did not end with mauved");
    }
    me_->leave();
    oracle_.note("=== mauved has ended");
    if (end.goes_on) static_cast<void>(place_.write("state/continue", ""));
    end.saved = read_generations(state() / "generations");
  }
  /// After a restart mauved is up.
  void begin(const End& end) {
    std::size_t order = 0;
    if (end.fresh) order = oracle_.ask({true}, "mauved --fresh");
    daemon_->start(end.fresh ? std::vector<std::string>{"--fresh"} : std::vector<std::string>{});
    const bool up = eventually([&] { return me_->connect() || !daemon_->process().running(); });
    if (!up || !me_->connected()) {
      return oracle_.violate("mauved does not come up again after " + end.words() + end_of_log());
    }
    if (end.fresh) oracle_.answer(order, Outcome::done, "mauved --fresh has begun");
    oracle_.note("=== mauved has begun");
    boot_ = me_->look("version")["boot"];
    const auto history = me_->look("config.history")["items"];
    oracle_.forget_lost_stops(history);
    oracle_.check_history(history);
    oracle_.check_saved(history);
    const auto first = first_of_this_run();
    if (oracle_.violations() == 0) expect_start(end, first);
    if (oracle_.violations() == 0) expect_it_runs();
    look_at_content(true);
  }
  /// The generation with which this run began, as it was saved.
  Json first_of_this_run() {
    Json content;
    static_cast<void>(eventually([&] {
      std::uint64_t first = 0;
      const auto history = me_->look("config.history");
      for (const auto& row : history.value("items", Json::array())) {
        const auto command = row.value("command", "");
        const bool its = command == "start" || command == "recover";
        if (its && row["boot"] == boot_) first = row["generation"];
      }
      const auto saved = read_generations(state() / "generations");
      if (saved.contains(first)) content = saved.at(first).content;
      return content.is_object();
    }));
    if (!content.is_object()) oracle_.violate("the start of mauved was not saved" + end_of_log());
    return content;
  }
  /// A confirmed generation is never lost by an end: after a crash the newest one is started,
  /// unless the log tells why not. A generation that was rolled back is never started.
  void expect_start(const End& end, const Json& first) {
    const auto log = me_->look("log.tail", {{"n", 1000}});
    std::uint64_t started = 0;
    std::set<std::uint64_t> excused;
    for (const auto& record : log["records"]) {
      const std::string event = record["event"];
      const auto number = record["fields"].value("generation", std::uint64_t{0});
      if (event == "generation_recovered" || event == "generation_continued") started = number;
      if (event != "generation_passed_over" && event != "generation_unusable") continue;
      excused.insert(number);
      if (event == "generation_passed_over" && crashes_ < kMostCrashes) {
        oracle_.violate("generation " + std::to_string(number) + " is passed over after " +
                        std::to_string(crashes_) + " crashes in a row");
      }
      counts_.add("generations not started: " + event);
    }
    std::uint64_t newest = 0;
    for (const auto& [number, saved] : end.saved) {
      if (saved.mark == "confirmed" && !excused.contains(number)) newest = number;
    }
    const auto confirmed = oracle_.confirmed();
    const std::string numbers =
        "generation " + std::to_string(started) + " is started after " + end.words() + "; ";
    if (!end.recovers() && started != 0) oracle_.violate(numbers + "the file was to be started");
    if (end.recovers() && excused.empty() && started != newest) {
      oracle_.violate(numbers + "the newest confirmed one is " + std::to_string(newest));
    }
    if (end.recovers() && excused.empty() && started < confirmed) {
      oracle_.violate(numbers + std::to_string(confirmed) + " was answered as confirmed");
    }
    if (started != 0 && end.saved.at(started).mark != "confirmed") {
      oracle_.violate(numbers + "it is marked as " + end.saved.at(started).mark);
    }
    counts_.add(started == 0 ? "starts of the file" : "starts of a saved generation");
    expect_content(end, started == 0 ? file_ : end.saved.at(started).content, first);
  }
  /// The start has the content of its origin, the stops of the generation in force at a crash, and
  /// the stops of users, and nothing else stands.
  void expect_content(const End& end, const Json& origin, const Json& first) {
    if (lasting_part(first) != lasting_part(origin)) {
      oracle_.violate("the start has " + first.dump() + "\nand its origin " + origin.dump());
    }
    expect_not_all_stand(end, origin, first);
    const Json newest = end.saved.empty() ? file_ : end.saved.rbegin()->second.content;
    for (const auto& [name, component] : first["components"].items()) {
      const bool was_stopped = !starts(origin, name) || (end.recovers() && !starts(newest, name));
      const bool runs = starts(first, name);
      const bool may_run = !was_stopped && !oracle_.must_stand(name);
      const bool must_run = !was_stopped && !oracle_.may_stand(name);
      if ((runs && !may_run) || (!runs && must_run)) {
        oracle_.violate(name + (runs ? " starts" : " stands") + " after " + end.words() +
                        "; stopped by a generation: " + (was_stopped ? "yes" : "no") +
                        ", by a user: " +
                        (must_run  ? "no"
                         : may_run ? "perhaps"
                                   : "yes") +
                        end_of_log());
      }
      counts_.add(must_run  ? "components that must start"
                  : may_run ? "components that may start"
                            : "components that must stand");
    }
  }
  /// The stop with which mauved itself ends is no stop of a user: a robot that ran does not stand
  /// as a whole afterwards.
  void expect_not_all_stand(const End& end, const Json& origin, const Json& first) {
    for (const auto& [name, component] : first["components"].items()) {
      if (starts(first, name)) return;
    }
    if (!end.recovers() || oracle_.moved_since(end.looked)) return;
    for (const auto& row : end.last) {
      const std::string name = row["name"];
      const bool by_rules = name == "b" || name == "c";
      const bool ran = row["state"] == "running" && first["components"].contains(name);
      if (ran && !by_rules && starts(origin, name) && !oracle_.may_stand(name)) {
        oracle_.violate(name + " ran, nobody has stopped it, and all components stand after " +
                        end.words() + end_of_log());
      }
    }
  }
  /// Each component runs or stands as the generation in force says, but one that failed.
  void expect_it_runs() {
    Json before;
    Json content;
    const bool still = eventually([&] {
      before = me_->status();
      content = me_->look("config.get")["architecture"];
      return me_->status().value("generation", Json(0)) == before.value("generation", Json(1));
    });
    if (!still) return oracle_.violate("no two looks find the same generation");
    for (const auto& row : before["components"]) {
      const std::string name = row["name"];
      const std::string state = row["state"];
      const bool runs = state == "running" || state == "recovering";
      const bool failed = state == "faulted" && may_fail(name);
      if (starts(content, name) ? !runs && !failed : state != "stopped") {
        oracle_.violate(name + " is to " + (starts(content, name) ? "run" : "stand") +
                        " in the generation in force: " + row.dump());
      }
    }
  }
  [[nodiscard]] std::string end_of_log() const {
    constexpr std::size_t kMuch = 3000;
    const auto log = daemon_->errors();
    return "\n" + log.substr(log.size() - std::min(log.size(), kMuch));
  }

  const std::filesystem::path signs_ = place_ / "signs";
  std::mt19937_64 random_{seed_};
  Json file_;
  std::string boot_;
  int crashes_ = 0;  ///< since the last orderly end
  std::unique_ptr<TrialDaemon> daemon_;
  std::unique_ptr<StormUser> me_;
  StormCounts counts_;
  StormGate gate_;
};

TEST_F(Storm, KeepsWhatWasAnswered) {
  std::printf("seed %lu, %lu s\n", seed_, seconds_);
  std::fflush(stdout);
  rage();
  report();
  EXPECT_EQ(oracle_.violations(), 0);
}

}  // namespace
}  // namespace mauve::test
