// SPDX-License-Identifier: LGPL-3.0-or-later
/// Engine: evaluates all rules and returns those that fire now. Applies nothing, reads no clock.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rules/sight.h"
#include "rules/supervision.h"
#include "rules/trigger.h"

namespace mauve::rules {

/// Names one rule as long as the engine lives: a rule that replaces it has another number.
using RuleId = std::uint64_t;

/// The state of a rule, for people.
struct Report {
  State state = State::armed;
  Values values;                ///< of all addresses of the condition
  std::uint64_t times = 0;      ///< it fired
  std::optional<Instant> last;  ///< firing
  std::string answer;           ///< to the last firing; empty: none yet
  std::string why_not;          ///< it does not fire now: "holds for 0.4 of 2 s"
};

/// How a firing ended.
enum class Ended : std::uint8_t {
  done,     ///< applied, or partly; or there was nothing to do
  refused,  ///< nothing changed; the rule tries again, at growing pauses of 1 s to 1 min
  not_now,  ///< the same, because of a lock or a change under way; it tries again after 1 s
};

/// Why this rule may not fire now; empty: it may.
using Held = std::function<std::string_view(const Rule&)>;

/// Used by one thread, [control].
class Engine {
 public:
  Engine() = default;
  explicit Engine(std::vector<Rule> rules);

  [[nodiscard]] const std::vector<Rule>& rules() const { return rules_; }
  [[nodiscard]] RuleId id(std::size_t rule) const { return watched_[rule].id; }
  /// These rules from now on. Those for which `keeps` is true are in force already and go on as
  /// they are, by their names. The others begin anew, armed.
  void replace(std::vector<Rule> rules, const std::function<bool(const Rule&)>& keeps);

  /// The rules that fire now, as indices. A rule that fired waits for its answer, then for its
  /// `until`. Without `held`, all may fire.
  [[nodiscard]] std::vector<std::size_t> step(Instant now, const ReadFresh& read,
                                              const Held& held = {});
  /// The values that became unknown, or known again, in the last step(). A value that several rules
  /// look at is there once.
  [[nodiscard]] const std::vector<SightChange>& changes() const { return changes_; }
  /// All values that are unknown now and were reported as such.
  [[nodiscard]] std::vector<SightChange> lost() const;
  /// The result of the firing: "applied", "refused: ...". A rule tries again while its condition
  /// holds, and no sooner than after its cool_down. A rule that is gone is passed over.
  void answered(RuleId rule, std::string answer, Ended ended = Ended::done);
  /// The rules that have no effect although their condition holds, as indices: their transaction is
  /// refused, or they may not fire now, or not so often.
  [[nodiscard]] std::vector<std::size_t> blocked() const;

  /// The change that the firing made, or that left it nothing to do, was undone: the rule fires
  /// again while its condition holds. A rule that is gone is passed over.
  void undone(RuleId rule);

  /// How long this rule, by its index, may not fire because of its per_hour.
  [[nodiscard]] Duration limited(std::size_t rule, Instant now) const {
    return watched_[rule].trigger.limited(now);
  }
  [[nodiscard]] Report report(std::size_t rule, Instant now, const ReadFresh& read) const;

 private:
  struct Watched {
    RuleId id;
    Trigger trigger;
    std::string error;  ///< why the condition cannot be evaluated
    bool waits_for_answer = false;
    std::string answer;
    std::string held;       ///< why it may not fire
    unsigned refusals = 0;  ///< one after the other, while the condition holds
  };

  [[nodiscard]] std::string why_not(const Watched& watched, const Rule& rule, Instant now,
                                    const Read& read) const;

  /// A value that rules look at, as of the last step. Rules with the same max_age share it.
  using Looked = std::pair<std::string, Duration>;  // the address and the max_age
  struct Seen {
    Sight sight;
    Result<Value> value = Value();
    std::vector<std::string> rules;
  };

  [[nodiscard]] Watched* find(RuleId rule);
  /// The addresses that the rules look at. A value that was seen before stays seen.
  void look_at_addresses();
  void look(Instant now, const ReadFresh& read);
  /// The truth that counts: unknown is yes for a rule with Unknown::fire.
  [[nodiscard]] Truth answered_by(const Rule& rule, const Watched& watched, Truth truth) const;

  RuleId next_id_ = 0;
  std::vector<Rule> rules_;
  std::vector<Watched> watched_;  // by rule
  std::map<Looked, Seen> seen_;
  std::vector<SightChange> changes_;
};

}  // namespace mauve::rules
