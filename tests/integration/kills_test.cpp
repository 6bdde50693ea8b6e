// SPDX-License-Identifier: LGPL-3.0-or-later
/// Nothing that was answered as saved is lost: mauved is killed MAUVE_KILLS times (6), each time
/// right after an answer, in an order of changes that MAUVE_SEED decides. One state directory lives
/// through many kills, as that of a robot.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "kept_daemon.h"
#include "kept_oracle.h"
#include "support/number_in.h"

namespace mauve::test {
namespace {

using std::chrono::steady_clock;

/// A component of 2 ms has proved itself in six seconds, a start in ten.
constexpr std::chrono::seconds kMayProve{5};

/// A request, and what it makes of the system when it is answered as applied.
struct Step {
  std::string method;
  Json params = Json::object();
  std::function<void(Json&)> makes = [](Json&) {};
  enum class Kind : std::uint8_t { trial, taken, order, undo, confirm, other } kind = Kind::other;
};

/// mauved in one run, and what the answers say about it.
class Robot {
 public:
  Robot(TrialDaemon& daemon, std::filesystem::path state, KeptOracle& oracle,
        std::mt19937_64& random)
      : daemon_(daemon),
        state_(std::move(state)),
        oracle_(oracle),
        random_(random),
        client_(daemon.client()) {
    const auto hello = client_.ask("status.get")["result"];
    now_ = client_.ask("config.get")["result"]["architecture"];
    generation_ = hello.value("generation", std::uint64_t{0});
    build_ = 1;
  }

  [[nodiscard]] const Json& now() const { return now_; }
  [[nodiscard]] std::uint64_t generation() const { return generation_; }
  [[nodiscard]] Json quarantine() {
    return client_.ask("quarantine.list")["result"].value("cores", Json::array());
  }

  [[nodiscard]] Step next() {
    if (lock_ != "none" && below(2) == 0) return lock("none");
    switch (below(15)) {
      case 0:
        return lock(below(2) == 0 ? "params" : "all");
      case 1:
      case 2:
        return {"change.confirm", Json::object(), [](Json&) {}, Step::Kind::confirm};
      case 3:
      case 4:
        return {"change.undo", Json::object(), [](Json&) {}, Step::Kind::undo};
      case 5:
      case 6:
        return stop_or_start();
      case 7:
        return reload();
      case 8:
        return apply();
      case 9:
        return roll_back();
      case 10:
        return quarantined_ ? Step{"quarantine.release", {{"core", kFailing}}}
                            : Step{"core.swap", {{"component", "first"}, {"core", kFailing}}};
      case 11:
        return swap();
      case 12:
        return {"log.set_level", {{"level", below(2) == 0 ? "info" : "warning"}}};
      default:
        return set();
    }
  }
  /// False: the step is not answered in one piece, so its answer is no moment for a kill.
  [[nodiscard]] static bool may_be_last(const Step& step) {
    return step.params.value("core", "") != kFailing || step.method != "core.swap";
  }

  /// Sends it; kills mauved as soon as the answer is there, or goes on.
  void take(const Step& step, bool kill) {
    if (step.method == "plugin.reload") daemon_.install(build_ = 3 - build_);
    const auto answer = client_.ask(step.method, step.params);
    if (kill) daemon_.process().signal(SIGKILL);
    ASSERT_TRUE(answer.is_object()) << step.method << daemon_.errors();
    story_ += "\n  " + step.method + " " + step.params.dump().substr(0, 100) + " -> " +
              answer.dump().substr(0, 400);
    if (answer.contains("error")) return;
    ++applied_[step.method];
    account(step, answer["result"]);
    if (kill) return static_cast<void>(daemon_.process().wait());
    if (!may_be_last(step)) wait_for_quarantine(answer["result"]);
    const auto exported = client_.ask("config.get")["result"]["architecture"];
    EXPECT_EQ(exported, now_) << "the test does not know what this does" << story_;
  }
  [[nodiscard]] const std::string& story() const { return story_; }
  [[nodiscard]] const std::map<std::string, int>& applied() const { return applied_; }
  /// What the core that fails is after the last answer.
  [[nodiscard]] bool quarantined() const { return quarantined_; }
  void set_quarantined(bool is) { quarantined_ = is; }

 private:
  static constexpr const char* kFailing = "trial/throwing_job";

  std::size_t below(std::size_t limit) { return random_() % limit; }
  double some_gain() { return 2.0 + 0.5 * static_cast<double>(below(15)); }
  static Json& properties(Json& system, const std::string& component) {
    return system["components"][component]["properties"];
  }

  Step lock(const std::string& word) { return {"lock.set", {{"lock", word}}}; }
  /// Half of the changes have proved nothing before somebody confirms them.
  Step of(std::string method, Json params, std::function<void(Json&)> makes) {
    const auto way = below(4);
    if (way == 0) params["confirm_within"] = "600s";
    if (way == 1) params["probation"] = "9000000";
    if (way > 1) params["probation"] = "off";
    return {std::move(method), std::move(params), std::move(makes),
            way > 1 ? Step::Kind::taken : Step::Kind::trial};
  }
  Step set() {
    const std::string component = below(2) == 0 ? "first" : "second";
    const auto gain = some_gain();
    return of("param.set", {{"values", {{component + ".core.gain", gain}}}},
              [=](Json& system) { properties(system, component)["core.gain"] = gain; });
  }
  Step swap() {
    const std::vector<std::string> cores{"trial/steady", "trial/other", "trial/counting"};
    const auto core = cores[below(cores.size())];
    const auto gain = some_gain();
    return of("core.swap", {{"component", "first"}, {"core", core}, {"set", {{"gain", gain}}}},
              [=](Json& system) {
                system["components"]["first"]["core"] = core;
                properties(system, "first")["core.gain"] = gain;
              });
  }
  /// Both components at once, and one that joins or leaves: what must never be mixed.
  Step apply() {
    Json wanted = now_;
    properties(wanted, "first")["core.gain"] = some_gain();
    properties(wanted, "second")["core.gain"] = some_gain();
    auto& components = wanted["components"];
    if (components.contains("guest")) {
      components.erase("guest");
    } else {
      components["guest"] = components["first"];
      components["guest"].erase("ports");
    }
    return of("architecture.apply", {{"text", wanted.dump()}},
              [wanted](Json& system) { system = wanted; });
  }
  Step roll_back() {
    auto it = oracle_.all().begin();
    std::advance(it, below(oracle_.all().size()));
    const Json content = it->second.content;
    if (content.is_null() || content.dump().find(kFailing) != std::string::npos) return set();
    return {"config.rollback",
            {{"generation", it->first}, {"state", "drop"}},
            [content](Json& system) { system = content; },
            Step::Kind::trial};
  }
  Step reload() {
    return {"plugin.reload",
            {{"plugin", "trial"}, {"state", "drop"}, {"probation", "off"}},
            [](Json&) {},
            Step::Kind::trial};
  }
  Step stop_or_start() {
    const Json params = {{"components", {"second"}}};
    if (now_["components"]["second"].contains("start")) {
      return {"component.start", params,
              [](Json& system) { system["components"]["second"].erase("start"); },
              Step::Kind::order};
    }
    return {"component.stop", params,
            [](Json& system) { system["components"]["second"]["start"] = false; },
            Step::Kind::order};
  }

  void account(const Step& step, const Json& result) {
    EXPECT_TRUE(step.method == "component.stop" || result.value("saved", false))
        << step.method << ": " << result << story_;
    if (step.method == "lock.set") lock_ = step.params["lock"];
    if (step.method == "quarantine.release") quarantined_ = false;
    if (step.kind == Step::Kind::confirm) return confirm();
    if (step.kind == Step::Kind::other || !result.value("changed", false)) return;
    if (!may_be_last(step)) return;
    const auto* before = oracle_.find(generation_);
    const auto its = before == nullptr ? Worth::either : before->worth;
    const auto number = result["generation"].get<std::uint64_t>();
    Kept next{now_, Worth::unconfirmed, step.method != "component.stop"};
    // A file that only starts or stops something has nothing to prove.
    const bool order = step.kind == Step::Kind::order ||
                       (step.method == "config.rollback" && !result.contains("probation"));
    if (step.kind == Step::Kind::undo) {
      undo(next);
    } else {
      step.makes(next.content);
      if (!order) open(step, result, next.content);
    }
    if (step.kind == Step::Kind::taken && open_.empty()) next.worth = Worth::confirmed;
    if (order) {
      next.worth = its;
      for (auto& one : open_) one.ordered = true;
    }
    now_ = next.content;
    generation_ = number;
    oracle_.add(number, std::move(next));
  }
  /// A change on probation, with those that it joined: the components as they were before.
  struct Open {
    std::uint64_t before = 0;  ///< the generation
    std::uint64_t newest = 0;
    std::map<std::string, Json> components;
    bool ordered = false;  ///< something was stopped or started by request since then

    void join(const Open& earlier) {
      before = std::min(before, earlier.before);
      ordered = ordered || earlier.ordered;
      for (const auto& [component, content] : earlier.components) components[component] = content;
    }
  };
  /// The components that it changes; a swap and a reload change those that stay the same, too.
  [[nodiscard]] std::map<std::string, Json> touched(const Step& step, const Json& next) const {
    std::map<std::string, Json> found;
    for (const std::string component : {"first", "second", "guest"}) {
      const Json before = now_["components"].value(component, Json());
      const bool swapped = step.method == "core.swap" && component == "first";
      const bool reloaded = step.method == "plugin.reload" && !before.is_null();
      if (swapped || reloaded || before != next["components"].value(component, Json())) {
        found[component] = before;
      }
    }
    return found;
  }
  /// The notes of an answer tell which probations a change joins, and which it ends.
  static std::string told_about(const Json& notes, std::uint64_t generation) {
    const auto last = std::to_string(generation) + " (";
    for (const auto& one : notes) {
      const auto note = one.get<std::string>();
      const bool names = note.find("generation " + last) != std::string::npos ||
                         note.find(" to " + last) != std::string::npos;
      if (names) return note;
    }
    return {};
  }
  void open(const Step& step, const Json& result, const Json& next) {
    Open fresh{generation_, result["generation"], touched(step, next)};
    bool joins = false;
    std::erase_if(open_, [&](const Open& earlier) {
      const auto note = told_about(result.value("notes", Json::array()), earlier.newest);
      if (note.find(" joins ") == std::string::npos) return !note.empty();
      joins = true;
      fresh.join(earlier);
      return true;
    });
    const bool tried =
        step.kind == Step::Kind::trial && step.params.value("probation", "") != "off";
    if (joins || tried) open_.push_back(std::move(fresh));
  }
  /// It confirms what runs, so also what that came from on its probation.
  void confirm() {
    auto number = generation_;
    for (const auto& one : open_) number = std::min(number, one.before + 1);
    for (; number < generation_; ++number) oracle_.set_worth(number, Worth::either);
    oracle_.set_worth(generation_, Worth::confirmed);
    open_.clear();
  }
  /// Of the newest change. What was stopped or started meanwhile stays so.
  void undo(Kept& next) {
    if (open_.empty()) return;
    auto& components = next.content["components"];
    for (const auto& [component, before] : open_.back().components) {
      const Json start = components.value(component, Json::object()).value("start", Json());
      components.erase(component);
      if (before.is_null()) continue;
      components[component] = before;
      if (!open_.back().ordered) continue;
      components[component].erase("start");
      if (!start.is_null()) components[component]["start"] = start;
    }
    const auto* earlier = oracle_.find(open_.back().before);
    open_.pop_back();
    const bool proved = earlier == nullptr || earlier->worth != Worth::unconfirmed;
    next.worth = proved && open_.empty() ? Worth::either : Worth::unconfirmed;
  }
  /// The swap is rolled back at the next release, with the changes that it joined; the generation
  /// of that has the content of before. It may be in force when the swap is answered, and then it
  /// alone is kept. The list of cores in quarantine is saved after it.
  void wait_for_quarantine(const Json& answer) {
    EXPECT_TRUE(eventually([&] {
      return TempDir::read(state_ / "quarantine.json").find(kFailing) != std::string::npos;
    })) << story_
        << "\n"
        << client_.ask("status.get") << client_.ask("quarantine.list");
    const auto newest = client_.ask("config.history", {{"n", 1}})["result"]["items"][0];
    Kept next{now_};
    open({"core.swap", Json::object(), {}, Step::Kind::trial}, answer, now_);
    undo(next);
    const auto number = newest["generation"].get<std::uint64_t>();
    for (auto made = generation_ + 1; made < number; ++made) oracle_.add(made, {});
    now_ = next.content;
    oracle_.add(number, std::move(next));
    generation_ = number;
    quarantined_ = true;
  }

  TrialDaemon& daemon_;
  const std::filesystem::path state_;
  KeptOracle& oracle_;
  std::mt19937_64& random_;
  RawClient client_;
  Json now_;
  std::uint64_t generation_ = 0;
  std::vector<Open> open_;  ///< the newest last
  std::string lock_ = "none";
  bool quarantined_ = false;
  int build_ = 1;
  std::string story_;
  std::map<std::string, int> applied_;
};

class Kills : public Generations {
 protected:
  /// One run: some changes, then a kill after the answer to one of them, or now and then an end.
  void live(TrialDaemon& daemon) {
    const auto begin = steady_clock::now();
    Robot robot(daemon, state(), oracle_, random_);
    expect_start(robot, daemon);
    if (HasFailure()) return;
    robot.set_quarantined(quarantined_);
    const bool ends = random_() % 12 == 0;
    for (auto left = random_() % 7; left > 0 && !HasFailure(); --left) {
      robot.take(robot.next(), false);
    }
    auto last = robot.next();
    while (!Robot::may_be_last(last)) last = robot.next();
    if (!HasFailure()) robot.take(last, !ends);
    for (const auto& [method, count] : robot.applied()) applied_[method] += count;
    quarantined_ = robot.quarantined();
    if (ends && !HasFailure()) {
      daemon.process().signal(SIGTERM);
      EXPECT_EQ(daemon.process().wait(), 0) << daemon.errors();
    }
    daemon.process().signal(SIGKILL);
    static_cast<void>(daemon.process().wait());
    oracle_.compare(state() / "generations", steady_clock::now() - begin > kMayProve);
    wanted_ = ends ? Json() : oracle_.after_crash();
    if (ends) oracle_.after_end();
    story_ = robot.story() + (ends ? "\n  SIGTERM" : "\n  SIGKILL");
  }
  void expect_start(Robot& robot, TrialDaemon& daemon) {
    if (file_.is_null()) file_ = robot.now();
    EXPECT_EQ(robot.now(), wanted_.is_null() ? file_ : wanted_)
        << "the run before:" << story_ << "\n"
        << daemon.errors().substr(daemon.errors().size() -
                                  std::min<std::size_t>(daemon.errors().size(), 2000));
    EXPECT_EQ(robot.quarantine().empty(), !quarantined_) << "the run before:" << story_;
    oracle_.begin(robot.generation(), robot.now());
  }
  /// Another robot.
  void begin_anew() {
    std::filesystem::remove_all(state());
    oracle_ = {};
    wanted_ = nullptr;
    quarantined_ = false;
    story_ = " none";
  }

  const std::uint64_t seed_ = number_in("MAUVE_SEED", 1);
  std::mt19937_64 random_{seed_};
  KeptOracle oracle_;
  Json file_;
  Json wanted_;
  bool quarantined_ = false;
  std::string story_ = " none";
  std::map<std::string, int> applied_;
};

TEST_F(Kills, RightAfterAnAnswerLoseNothingAndStartNothingElse) {
  constexpr std::uint64_t kOfOneRobot = 100;
  const auto kills = number_in("MAUVE_KILLS", 6);
  std::printf("seed %lu, %lu kills\n", seed_, kills);
  auto words = options();
  words.insert(words.end(), {"--flight-recorder", "off"});
  TrialDaemon daemon(kTrial, words);
  for (std::uint64_t kill = 1; kill <= kills; ++kill) {
    SCOPED_TRACE("seed " + std::to_string(seed_) + ", kill " + std::to_string(kill));
    live(daemon);
    ASSERT_FALSE(HasFailure()) << "the run:" << story_;
    if (kill % 50 == 0) {
      std::printf("%lu kills\n", kill);
      std::fflush(stdout);
    }
    if (kill % kOfOneRobot == 0) begin_anew();
    daemon.start();
  }
  for (const auto& [method, count] : applied_) std::printf("%6d %s\n", count, method.c_str());
}

}  // namespace
}  // namespace mauve::test
