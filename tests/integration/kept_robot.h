// SPDX-License-Identifier: LGPL-3.0-or-later
/// A robot that is changed at random, and the books of the changes that mauved must keep.
#pragma once

#include <signal.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "kept_oracle.h"
#include "open_changes.h"
#include "support/eventually.h"
#include "support/temp_dir.h"
#include "trial_daemon.h"

namespace mauve::test {

/// A request, and the change that it makes to the system when mauved answers that it is applied.
struct Step {
  std::string method;
  Json params = Json::object();
  std::function<void(Json&)> makes = [](Json&) {};
  enum class Kind : std::uint8_t { trial, applied, order, undo, confirm, other } kind = Kind::other;
};

/// One run of mauved, with the system as its answers describe it.
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

  [[nodiscard]] Step next();
  /// False: the step is not answered in one piece, so its answer is no moment for a kill.
  [[nodiscard]] static bool may_be_last(const Step& step) {
    return step.params.value("core", "") != kFailing || step.method != "core.swap";
  }

  /// Sends it; kills mauved as soon as the answer is there, or goes on.
  void take(const Step& step, bool kill);
  [[nodiscard]] const std::string& story() const { return story_; }
  [[nodiscard]] const std::map<std::string, int>& applied() const { return applied_; }
  /// After the last answer, is the core that fails in quarantine?
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
  Step of(std::string method, Json params, std::function<void(Json&)> makes);
  Step set();
  Step swap();
  /// Both components at once, and one that joins or leaves: what must never be mixed.
  Step apply();
  Step roll_back();
  Step reload() {
    return {"plugin.reload",
            {{"plugin", "trial"}, {"state", "drop"}, {"probation", "off"}},
            [](Json&) {},
            Step::Kind::trial};
  }
  Step stop_or_start();

  void account(const Step& step, const Json& result);
  /// The components that it changes; a swap and a reload change those that stay the same, too.
  [[nodiscard]] std::map<std::string, Json> touched(const Step& step, const Json& next) const;
  void open(const Step& step, const Json& result, const Json& next) {
    const bool has_probation =
        step.kind == Step::Kind::trial && step.params.value("probation", "") != "off";
    open_.add({generation_, result["generation"], touched(step, next)},
              result.value("notes", Json::array()), has_probation);
  }
  /// It confirms what runs, so also what that came from on its probation.
  void confirm() {
    for (auto number = open_.first_after(generation_); number < generation_; ++number) {
      oracle_.set_worth(number, Worth::either);
    }
    oracle_.set_worth(generation_, Worth::confirmed);
    open_.clear();
  }
  void undo(Kept& next) {
    if (open_.empty()) return;
    const auto* earlier = oracle_.find(open_.undo(next.content));
    const bool proved = earlier == nullptr || earlier->worth != Worth::unconfirmed;
    next.content = oracle_.with_stops(next.content);
    next.worth = proved && open_.empty() ? Worth::either : Worth::unconfirmed;
  }
  /// The swap is rolled back at the next release, with the changes that it joined; the generation
  /// of that has the content of before. It may be in force when the swap is answered, and then it
  /// alone is kept. The list of cores in quarantine is saved after it.
  void wait_for_quarantine(const Json& answer);

  TrialDaemon& daemon_;
  const std::filesystem::path state_;
  KeptOracle& oracle_;
  std::mt19937_64& random_;
  RawClient client_;
  Json now_;
  std::uint64_t generation_ = 0;
  OpenChanges open_;
  std::string lock_ = "none";
  bool quarantined_ = false;
  int build_ = 1;
  std::string story_;
  std::map<std::string, int> applied_;
};

}  // namespace mauve::test
