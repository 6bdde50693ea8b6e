// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/engine.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace mauve::rules {
namespace {

/// "0.4", "12.5", "90".
std::string seconds(Duration duration) {
  char text[40];
  const double seconds = std::chrono::duration<double>(duration).count();
  std::snprintf(text, sizeof text, seconds < 100 ? "%.3g" : "%.0f", seconds);
  return text;
}

/// 1, 2, 4 s and so on up to a minute: a rule that is refused does not fill the log.
Duration pause_after(unsigned refusals) {
  return std::min<Duration>(1min, Duration{1s} * (1U << std::min(refusals - 1, 6U)));
}

}  // namespace

Engine::Engine(std::vector<Rule> rules) {
  replace(std::move(rules), [](const Rule&) { return false; });
}

void Engine::replace(std::vector<Rule> rules, const std::function<bool(const Rule&)>& keeps) {
  std::vector<Watched> watched;
  for (const Rule& rule : rules) {
    const auto before = std::ranges::find(rules_, rule.name, &Rule::name);
    if (before != rules_.end() && keeps(rule)) {
      watched.push_back(std::move(watched_[static_cast<std::size_t>(before - rules_.begin())]));
    } else {
      watched.push_back({next_id_++, Trigger(rule.timing), {}, false, {}, {}, 0});
    }
  }
  rules_ = std::move(rules);
  watched_ = std::move(watched);
  look_at_addresses();
}

void Engine::look_at_addresses() {
  const auto before = std::exchange(seen_, {});
  for (const Rule& rule : rules_) {
    const auto looks_at = [&](const Condition& condition) {
      for (const Comparison& one : condition.comparisons()) {
        std::vector<std::string>& names = seen_[{one.address, rule.max_age}].rules;
        if (names.empty() || names.back() != rule.name) names.push_back(rule.name);
      }
    };
    looks_at(rule.when);
    if (rule.until) looks_at(*rule.until);
  }
  for (auto& [looked, seen] : seen_) {
    const auto known = before.find(looked);
    if (known == before.end()) continue;
    seen.sight = known->second.sight;
    seen.value = known->second.value;
  }
}

Engine::Watched* Engine::find(RuleId rule) {
  const auto found = std::ranges::find(watched_, rule, &Watched::id);
  return found == watched_.end() ? nullptr : &*found;
}

void Engine::look(Instant now, const ReadFresh& read) {
  changes_.clear();
  for (auto& [looked, seen] : seen_) {
    const auto& [address, max_age] = looked;
    seen.value = read(address, max_age);
    if (!seen.sight.step(now, is_known(seen.value))) continue;
    changes_.push_back(
        {address, seen.value ? *seen.value : Value(), seen.sight.lost(), seen.rules, max_age});
  }
}

std::vector<SightChange> Engine::lost() const {
  std::vector<SightChange> lost;
  for (const auto& [looked, seen] : seen_) {
    if (!seen.sight.lost()) continue;
    const auto& [address, max_age] = looked;
    lost.push_back({address, seen.value ? *seen.value : Value(), true, seen.rules, max_age});
  }
  return lost;
}

Truth Engine::answered_by(const Rule& rule, const Watched& watched, Truth truth) const {
  if (truth != Truth::unknown || rule.when_unknown == Unknown::hold || !watched.error.empty()) {
    return truth;
  }
  const auto is_lost = [&](const Comparison& one) {
    const Seen& seen = seen_.find({one.address, rule.max_age})->second;
    return seen.sight.lost() && !is_known(seen.value);
  };
  return std::ranges::any_of(rule.when.comparisons(), is_lost) ? Truth::yes : truth;
}

std::vector<std::size_t> Engine::step(Instant now, const ReadFresh& read, const Held& held) {
  look(now, read);
  std::vector<std::size_t> fired;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const Rule& rule = rules_[i];
    Watched& watched = watched_[i];
    const Read as_seen = [&](const std::string& address) {
      return seen_.find({address, rule.max_age})->second.value;
    };
    watched.error.clear();
    watched.held = held ? held(rule) : std::string_view{};
    const Truth truth = rule.when.evaluate(as_seen, watched.error);
    const Truth when = answered_by(rule, watched, truth);
    Truth rearm = !when;
    if (rule.until) rearm = rule.until->evaluate(as_seen, watched.error);
    if (watched.waits_for_answer) rearm = Truth::no;
    const bool fires = watched.trigger.step(now, when, rearm, watched.held.empty());
    if (watched.trigger.state() == State::armed) watched.refusals = 0;
    if (!fires) continue;
    watched.waits_for_answer = true;
    fired.push_back(i);
  }
  return fired;
}

void Engine::answered(RuleId rule, std::string answer, Ended ended) {
  Watched* const watched = find(rule);
  if (watched == nullptr) return;
  watched->waits_for_answer = false;
  watched->answer = std::move(answer);
  if (ended == Ended::not_now) watched->trigger.try_again();
  if (ended == Ended::done) watched->refusals = 0;
  if (ended == Ended::refused) watched->trigger.try_again(pause_after(++watched->refusals));
}

std::vector<std::size_t> Engine::blocked() const {
  std::vector<std::size_t> rules;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const State state = watched_[i].trigger.state();
    const bool may_not = state == State::held || state == State::limited;
    if (watched_[i].refusals > 0 || may_not) rules.push_back(i);
  }
  return rules;
}

void Engine::undone(RuleId rule) {
  Watched* const watched = find(rule);
  if (watched == nullptr) return;
  watched->trigger.fire_again();
  watched->answer = "undone";
}

Report Engine::report(std::size_t rule, Instant now, const ReadFresh& read_fresh) const {
  const Watched& watched = watched_[rule];
  const Read read = [&](const std::string& address) {
    return read_fresh(address, rules_[rule].max_age);
  };
  Report report;
  report.state = watched.error.empty() ? watched.trigger.state() : State::disabled;
  report.values = rules_[rule].when.values(read);
  report.times = watched.trigger.times();
  report.last = watched.trigger.last();
  report.answer = watched.waits_for_answer ? "under way" : watched.answer;
  report.why_not = why_not(watched, rules_[rule], now, read);
  return report;
}

std::string Engine::why_not(const Watched& watched, const Rule& rule, Instant now,
                            const Read& read) const {
  const Trigger& trigger = watched.trigger;
  if (!watched.error.empty()) return watched.error;
  const auto holds_for = [&](Duration held) {
    return "holds for " + seconds(held) + " of " + seconds(rule.timing.hold) + " s";
  };
  switch (trigger.state()) {
    case State::armed: {
      std::string error;
      const Truth truth = rule.when.evaluate(read, error);
      if (truth == Truth::yes) return holds_for(0s);  // since the last look
      return (truth == Truth::no ? "condition is false: " : "condition is unknown: ") +
             in_words(rule.when.values(read));
    }
    case State::holding:
      return holds_for(trigger.held(now));
    case State::fired:
      if (watched.waits_for_answer) return "fired, its transaction is under way";
      return "fired, to be armed again " +
             (rule.until ? "when " + rule.until->text() : "when the condition is false");
    case State::cooling_down:
      if (watched.refusals > 0) return "tries again in " + seconds(trigger.cooling(now)) + " s";
      return "cooling down " + seconds(trigger.cooling(now)) + " s more";
    case State::limited:
      return "limit " + std::to_string(rule.timing.per_hour) + " an hour reached, for " +
             seconds(trigger.limited(now)) + " s more";
    case State::held:
      return watched.held;
    case State::disabled:
      break;
  }
  return {};
}

}  // namespace mauve::rules
