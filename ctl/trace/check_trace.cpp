// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/actions.h"
#include "mtrace/check.h"
#include "render/table.h"
#include "render/words.h"
#include "trace/read_trace.h"

namespace mauve::ctl {
namespace {

using mtrace::Checked;
using mtrace::Verdict;
using mtrace::Violation;

Json json_of(const Checked& checked) {
  return {{"components", checked.components},
          {"releases", checked.releases},
          {"waits", checked.waits},
          {"states", checked.states},
          {"orders", checked.orders},
          {"missed", checked.missed},
          {"changes", checked.changes},
          {"takes", checked.takes},
          {"responses", checked.responses},
          {"responses_of", checked.responses_of},
          {"over_budget", checked.over_budget}};
}

Json json_of(const Violation& violation) {
  return {{"rule", violation.rule}, {"thread", violation.thread},   {"time_ns", violation.time},
          {"line", violation.line}, {"message", violation.message}, {"hint", violation.hint}};
}

Json json_of(const std::string& file, const Verdict& verdict) {
  Json json{{"file", file},
            {"holds", verdict.holds()},
            {"violations", verdict.found},
            {"violations_of", verdict.found_of},
            {"first", nullptr},
            {"checked", json_of(verdict.checked)},
            {"not_checked", verdict.not_checked}};
  if (!verdict.holds()) json["first"] = json_of(*verdict.first);
  return json;
}

std::string render(const Violation& violation, const Verdict& verdict, bool colour) {
  std::string text = painted("violated: ", Paint::red, colour) + harmless(violation.message) +
                     "\n  rule   : " + violation.rule +
                     "\n  where  : " + harmless(violation.thread) + " at " +
                     mtrace::instant_in_words(violation.time);
  if (violation.line > 0) text += ", line " + std::to_string(violation.line);
  text += "\n  hint   : " + violation.hint + "\n";
  if (verdict.found == 1) return text;
  std::string rules;
  for (const auto& [rule, times] : verdict.found_of)
    join(rules, std::to_string(times) + " of " + rule);
  return text + "  " + counted(verdict.found, "violation") + ", this is the first: " + rules + "\n";
}

std::string render(const Verdict& verdict, bool colour) {
  const Checked& checked = verdict.checked;
  std::string text = verdict.holds() ? painted("the trace obeys the model\n", Paint::green, colour)
                                     : render(*verdict.first, verdict, colour);
  if (checked.missed > 0) {
    text += "missed: " + counted(checked.missed, "release") +
            ", which the model permits to a late component\n";
  }
  std::string over;
  for (const auto& [component, jobs] : checked.over_budget) {
    join(over, counted(jobs, "job") + " of " + harmless(component));
  }
  if (!over.empty()) text += "over budget: " + over + "; the admitted bounds do not cover them\n";
  text += "checked: " + counted(checked.components, "component") + ", " +
          counted(checked.releases, "release") + " where the clock says, " +
          counted(checked.waits, "wait") + ", " + counted(checked.states, "state") + ", " +
          counted(checked.orders, "pair") + " of jobs in the order of their priorities, " +
          counted(checked.changes, "change") + " that components took " +
          counted(checked.takes, "time") + ", each at the decided release, " +
          counted(checked.responses, "response") + " within the bound\n";
  for (const std::string& what : verdict.not_checked) {
    text += "not checked: " + harmless(what) + "\n";
  }
  return text;
}

}  // namespace

int run_check_trace(Session& session) {
  const std::string file = session.arguments.one("FILE");
  const auto trace = read_trace(file);
  if (const auto* fault = std::get_if<Fault>(&trace)) return session.fail(*fault);
  const Verdict verdict = mtrace::check(std::get<mtrace::Trace>(trace));
  session.print(json_of(file, verdict), render(verdict, session.screen.colour_out));
  return verdict.holds() ? 0 : 1;
}

}  // namespace mauve::ctl
