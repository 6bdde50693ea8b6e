// SPDX-License-Identifier: LGPL-3.0-or-later
// No rollback comes between the look of a command and its act. Each way of the table that can
// change something is asked while a change on probation fails, passes or expires. It is asked
// shortly before and shortly after that, with and without the generation that its user has seen.
#include <chrono>
#include <fstream>
#include <set>
#include <thread>

#include "kept_daemon.h"
#include "locked_ways.h"
#include "support/sanitized.h"

namespace mauve::test {
namespace {

using std::chrono::milliseconds;

enum class End { fails, passes, expires };

/// How one way is asked.
struct Case {
  End end;
  bool conditional;    ///< with if_generation
  milliseconds later;  ///< after the change failed, or was put in force
};

/// `walked()` with a component that is tried out: its core writes a sign to this file in each job.
Json tried(const std::filesystem::path& signs) {
  Json file = walked();
  file["components"]["tried"] = {
      {"type", "trial/unit"},
      {"core", "trial/noting"},
      {"properties", {{"fsm.period", "2ms"}, {"core.file", signs.string()}}}};
  return file;
}

/// A file keeps the component.
Json with_tried(Json params, const std::filesystem::path& signs) {
  if (!params.contains("text")) return params;
  auto file = Json::parse(params["text"].get<std::string>());
  file["components"]["tried"] = tried(signs)["components"]["tried"];
  params["text"] = file.dump();
  return params;
}

class LookThenAct : public Generations {
 protected:
  void SetUp() override {
    std::filesystem::copy_file(MAUVE_PLUGIN_DIR "/demo.so", daemon_.plugins() / "demo.so");
    daemon_.install(2);
    ASSERT_EQ(daemon_.ask("change.confirm")["saved"], true);
  }

  void ask(const Way& way, const Case& how) {
    ASSERT_NO_FATAL_FAILURE(begin_anew());
    auto params = way.params;
    if (params.contains("generation")) params["generation"] = generation();
    for (const auto& [method, asked] : way.before) {
      const auto done = daemon_.ask(method, with_tried(asked, signs_));
      ASSERT_FALSE(done.contains("code")) << method << done;
    }
    const auto seen = try_out(how.end);
    if (how.conditional) params["if_generation"] = seen;
    if (how.end == End::fails) {
      ASSERT_NO_FATAL_FAILURE(let_fail());
    }
    std::this_thread::sleep_for(how.later);
    const auto answer = daemon_.ask(way.method, params);
    ASSERT_TRUE(comes_to_rest()) << daemon_.ask("status.get");
    if (answer.contains("code")) return;
    ++accepted_;
    expect_true(way, how, seen, answer);
  }
  /// A confirmation is among the cases where all of them are tried.
  void expect_looked(bool whole) const {
    EXPECT_GT(accepted_, 0) << "no way was let in";
    EXPECT_GT(saved_, 0) << "no change was found among the saved ones";
    if (whole) {
      EXPECT_GT(kept_, 0) << "nothing was confirmed";
    }
  }

  const std::filesystem::path trigger_ = place_ / "trigger";
  const std::filesystem::path signs_ = place_ / "signs";
  TrialDaemon daemon_{tried(signs_).dump(), options()};

 private:
  /// Until the thread of the component runs the core from before.
  void let_fail() {
    std::ofstream(signs_) << "?";
    std::ofstream(trigger_) << "now";
    ASSERT_TRUE(eventually([&] { return TempDir::read(signs_) == "+"; })) << daemon_.errors();
  }

  [[nodiscard]] std::uint64_t generation() { return daemon_.ask("status.get")["generation"]; }

  /// Puts a core that fails at a sign on probation, and returns the generation.
  std::uint64_t try_out(End end) {
    Json swap = {{"component", "tried"},
                 {"core", "trial/brittle"},
                 {"set", {{"until_there", trigger_.string()}}},
                 {"reason", "tried out"}};
    if (end == End::passes) swap["probation"] = "4";
    if (end == End::expires) swap["confirm_within"] = "10ms";
    const auto swapped = daemon_.ask("core.swap", swap);
    EXPECT_EQ(swapped.value("state", ""), "applied") << swapped;
    return swapped["generation"];
  }

  [[nodiscard]] bool comes_to_rest() {
    return eventually([&] {
      const auto status = daemon_.ask("status.get");
      return status.contains("probations") &&
             std::ranges::none_of(status["probations"], [](const Json& one) {
               return one["state"] == "rolls_back" || one["components"] == Json::array({"tried"});
             });
    });
  }

  void begin_anew() {
    std::filesystem::remove(trigger_);
    ASSERT_TRUE(eventually([&] {  // not while a rollback is under way
      daemon_.ask("change.confirm");
      daemon_.ask("quarantine.release", {{"core", "trial/brittle"}});
      const Json file = {{"text", tried(signs_).dump()}, {"probation", "off"}};
      return !daemon_.ask("architecture.apply", file).contains("code");
    })) << daemon_.errors();
    daemon_.ask("component.start", {{"components", {"first", "second", "tried"}}});
    if (daemon_.ask("plugin.list")["items"].size() != 1) {
      daemon_.ask("plugin.unload", {{"plugin", "demo"}});
    }
  }

  Json saved(std::uint64_t generation) {
    const auto history = daemon_.ask("config.history");
    for (const auto& row : history["items"]) {
      if (row["generation"] == generation) return row;
    }
    return {};
  }

  void expect_true(const Way& way, const Case& how, std::uint64_t seen, const Json& answer) {
    const std::uint64_t made = answer.value("generation", std::uint64_t{0});
    // [stop] carries out a stop by the newest generation that it knows.
    if (how.conditional && how.end == End::fails && way.method != "component.stop") {
      ADD_FAILURE() << "the generation was over: " << answer << history();
    }
    // A rollback of another component may end while the change comes into force.
    EXPECT_LE(made, seen + 2) << answer << history();
    if (answer.value("changed", false) && makes_a_generation(way)) {
      const auto row = saved(made);  // none: a rollback came before it was saved
      saved_ += row.is_null() ? 0 : 1;
      EXPECT_TRUE(row.is_null() || row["command"] == way.method) << answer << history();
    }
    for (const auto& one : answer.value("confirmed", Json::array())) expect_kept(one, answer);
  }

  /// And the answer names it; that of an undo names the one that runs.
  static bool makes_a_generation(const Way& way) {
    const std::set<std::string> others = {"change.confirm", "change.undo",        "plugin.load",
                                          "plugin.unload",  "quarantine.release", "service.call"};
    return !others.contains(way.method);
  }

  /// No change that was confirmed is rolled back.
  void expect_kept(const Json& confirmed, const Json& answer) {
    for (const auto& generation : confirmed["generations"]) {
      const auto row = saved(generation);
      kept_ += row.is_object() ? 1 : 0;
      EXPECT_FALSE(row.is_object() && row["mark"] == "rolled_back") << answer << history();
    }
  }

  std::string history() { return "\n" + daemon_.ask("config.history", {{"n", 8}}).dump(1); }

  int accepted_ = 0;
  int saved_ = 0;
  int kept_ = 0;
};

/// Two cases of each way, and one of every second way under a sanitizer; MAUVE_WHOLE: all cases.
constexpr unsigned kShare = support::kSanitized ? 12 : 3;

TEST_F(LookThenAct, HoldsForEveryWayToChangeSomething) {
  const bool whole = std::getenv("MAUVE_WHOLE") != nullptr;
  unsigned turn = 0;
  for (const Way& way : all_ways()) {
    for (const auto end : {End::fails, End::passes, End::expires}) {
      for (const bool conditional : {true, false}) {
        const unsigned number = turn++;
        if (!whole && number % kShare != (number / 6) % kShare) continue;
        const milliseconds later{(number * 5) % 16};
        SCOPED_TRACE(way.name + " (" + way.method + "), end " +
                     std::to_string(static_cast<int>(end)) + (conditional ? ", if" : "") + ", " +
                     std::to_string(later.count()) + " ms later");
        ASSERT_NO_FATAL_FAILURE(ask(way, {end, conditional, later}));
        if (HasFailure()) return;
      }
    }
  }
  expect_looked(whole);
}

}  // namespace
}  // namespace mauve::test
