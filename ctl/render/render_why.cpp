// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <string>

#include "render/render.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

std::string did_in_words(const Json& failure) {
  const std::string did = word(failure, "did");
  const std::string core = word(failure, "core_after");
  const std::string generation = " (generation " + word(failure, "generation_after") + ")";
  const std::string state = word(failure, "state_after");
  const bool stands = state == "stopped" || state == "faulted";
  if (did == "rolled_back")
    return "the change was rolled back: " + core +
           (stands ? " is in its place again, and the component is " + state : " runs again") +
           generation;
  if (did == "fell_back") return "its fallback core " + core + " took over" + generation;
  if (did == "restarted") return "a fresh core took over" + generation;
  if (did == "recovers")
    return "its safe values are written, and another core takes over by itself";
  return "it was stopped with its safe values written; others go on";
}

std::string what_happened(const Json& failure) {
  const std::string cause = word(failure, "cause");
  const std::string text = word(failure, "text");
  std::string line = cause.empty() ? text : cause + (text.empty() ? "" : ": " + text);
  if (line.empty()) line = "failed";
  if (const auto resource = word(failure, "resource"); !resource.empty()) {
    line += ", in a call of " + resource;
  }
  if (const auto state = word(failure, "fsm_state"); !state.empty()) line += ", in state " + state;
  if (const auto job = whole_number(failure, "job"); job > 0) {
    line += ", job " + std::to_string(job);
  }
  line += ", core " + word(failure, "core");
  if (const auto build = word(failure, "build_id"); !build.empty()) {
    line += " (build " + build.substr(0, 12) + ")";
  }
  return line;
}

/// "generation 42 by core.swap, uid 7, 2026-01-01T09:59:00Z: try it"; of a change that no user
/// asked for "generation 42 by rule gnss_lost, 2026-01-01T09:59:00Z".
std::string change_in_words(const Json& change) {
  const std::string reason = word(change, "reason");
  if (word(change, "method") == "supervision") {
    return "generation " + word(change, "generation") + " " + reason + ", " + word(change, "time");
  }
  return "generation " + word(change, "generation") + " by " + word(change, "method") + ", uid " +
         word(change, "uid") + ", " + word(change, "time") + (reason.empty() ? "" : ": " + reason);
}

/// "generations 2 to 3 were rolled back at 2026-01-31 12:00:00Z, in generation 4: not confirmed
/// before calm began"; empty: none was, or the failure tells of it.
std::string rollback_in_words(const Json& rollback, const Json& failure) {
  if (!rollback.is_object()) return {};
  if (number(rollback, "generation") == number(failure, "generation_after")) return {};
  const bool one = list_in(rollback, "undone").size() == 1;
  return changes_in_words({{"generations", list_in(rollback, "undone")}}) +
         (one ? " was" : " were") + " rolled back at " + time_in_words(word(rollback, "time")) +
         ", in generation " + word(rollback, "generation") +
         (member(rollback, "uid").is_null() ? "" : ", for " + user_in_words(rollback)) + ": " +
         word(rollback, "cause");
}

class Passage {
 public:
  explicit Passage(Look look) : look_(look) {}
  void add(const std::string& title, const std::string& content) {
    if (content.empty()) return;
    text_ +=
        wrapped(title + std::string(10 - std::min<std::size_t>(9, title.size()), ' ') + content,
                look_.width, 10) +
        "\n";
  }
  std::string text_;

 private:
  Look look_;
};

std::string listed(const Json& names) {
  std::string text;
  for (const Json& name : names) join(text, compact(name));
  return text;
}

/// "253 jobs over the budget of 100 us (longest 14.9 ms of processor time)"; empty: none was.
std::string over_budget_in_words(const Json& why) {
  const auto over = whole_number(why, "over_budget");
  if (over == 0) return {};
  return counted(over, "job") + " over the budget of " +
         nanoseconds_in_words(number(why, "budget_ns")) + " (longest " +
         nanoseconds_in_words(number(why, "used_max_ns")) + " of processor time)";
}

/// "did not fail, but is late: 126 releases missed, 259 overruns, 253 jobs over the budget ...";
/// empty: it is not late, and exceeded no budget.
std::string lateness_in_words(const Json& why, bool failed) {
  const std::string begin =
      failed ? "failed before, and is late now: " : "did not fail, but is late: ";
  const auto missed = whole_number(why, "missed");
  const auto overruns = whole_number(why, "overruns");
  std::string text = over_budget_in_words(why);
  if (missed == 0 && overruns == 0) return text.empty() ? text : "did not fail, but has " + text;
  return begin + counted(missed, "release") + " missed, " + counted(overruns, "overrun") +
         (text.empty() ? "" : ", " + text);
}

/// "output (12 values were not plausible), grip (1 value was not plausible)"
std::string implausible_in_words(const Json& why) {
  std::string text;
  for (const Json& one : list_in(why, "implausible")) {
    const auto values = whole_number(one, "count");
    join(text, word(one, "port") + " (" + counted(values, "value") +
                   (values > 1 ? " were" : " was") + " not plausible)");
  }
  return text;
}

/// The failure is history: the lateness has another reason.
bool is_late_after(const Json& why) { return member(why, "late_after") == true; }

std::string why_heading(const Json& why, const Json& failure) {
  const std::string state = word(why, "state");
  std::string line = word(why, "component") + ": " + state + ", core " + word(why, "core");
  if (number(why, "late_ns") > 0) {
    line += ", its job should have ended " + nanoseconds_in_words(number(why, "late_ns")) + " ago";
  }
  if (const auto how = recovery_in_words(member(why, "recovery")); !how.empty()) {
    line += ", " + how;
  }
  const bool failed = failure.is_object();
  if (failed && !is_late_after(why)) return line;
  if (const auto late = lateness_in_words(why, failed); !late.empty()) return line + "; " + late;
  if (!failed && !list_in(why, "implausible").empty()) {
    return line + "; did not fail, but its core wrote values that are not plausible";
  }
  return failed ? line : line + "; nothing failed since mauved began, " + word(why, "since");
}

}  // namespace

std::string render_why(const Json& why, Look look) {
  const Json failure = why.is_object() ? why.value("failure", Json()) : Json();
  const Json change = why.is_object() ? why.value("change", Json()) : Json();
  Passage text(look);
  const bool failed = word(why, "state") == "faulted" || word(why, "state") == "recovering";
  const Paint paint = failed ? Paint::red : Paint::bold;
  text.text_ =
      painted(wrapped(why_heading(why, failure), look.width, 2), paint, look.colour) + "\n";
  if (const auto by = word(why, "stopped_by"); member(why, "stopped_by").is_string()) {
    text.add("stopped",
             by + "; only mauvectl start " + word(why, "component") + " starts it again");
  }
  const Json& after = member(why, "change_after");
  if (after.is_object()) text.add("changed", change_in_words(after));
  if (failure.is_object()) {
    text.add(is_late_after(why) ? "failed" : "what", what_happened(failure));
    text.add("when", word(failure, "time") + ", " +
                         nanoseconds_in_words(number(failure, "ago_ns")) + " ago; " +
                         counted(whole_number(failure, "times"), "failure") +
                         " since mauved began");
    text.add("then", did_in_words(failure));
  }
  if (change.is_object())
    text.add(failure.is_object() ? "before" : "changed", change_in_words(change));
  text.add("back", rollback_in_words(member(why, "rollback"), failure));
  auto counts = counted(whole_number(why, "missed"), "release") + " missed, " +
                counted(whole_number(why, "overruns"), "overrun");
  if (const auto kernel = kernel_in_words(member(why, "kernel")); !kernel.empty()) {
    join(counts, kernel, "; ");
  }
  text.add("counted", counts);
  if (const auto ports = implausible_in_words(why); !ports.empty()) {
    text.add("withheld", "by " + ports + ": readers keep the value before");
  }
  text.add("poisoned", listed(list_in(why, "poisoned")));
  for (const Json& one : list_in(why, "quarantine")) {
    text.add("kept out", word(one, "core") + ": it " + word(one, "reason"));
  }
  for (const Json& hint : list_in(why, "hints")) text.add("next", compact(hint));
  const Json& records = list_in(why, "records");
  if (records.empty() || !failure.is_object()) return text.text_;
  const char* title = is_late_after(why) ? "its last records" : "records up to this failure";
  text.text_ += painted(title, Paint::bold, look.colour) + "\n";
  for (const Json& record : records) text.text_ += render_record(record, look);
  return text.text_;
}

}  // namespace mauve::ctl
