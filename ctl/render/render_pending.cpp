// SPDX-License-Identifier: LGPL-3.0-or-later
/// The pending things that `status` shows: changes on probation, a start after a crash, cores in
/// quarantine, unknown values that rules need, connections that may be a mistake.
#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {

namespace {

std::string sentence_of(const Json& one) {
  const std::string which = changes_in_words(one);
  const std::string left = seconds_in_words(number(one, "left_ns") * 1e-9);
  const std::string state = word(one, "state");
  if (state == "rolls_back") return which + ": a failure or undo has begun its rollback";
  if (state == "awaits_confirmation") {
    return which + ": goes back in " + left + " unless somebody confirms it: mauvectl confirm";
  }
  // A number of jobs that a user gave decides alone.
  const bool jobs_alone = number(one, "left_ns") > 3600e9;
  return which + ": on probation for " + (jobs_alone ? "" : left + " still, or ") +
         counted(whole_number(one, "jobs_left"), "job") +
         (state == "awaits_undo" ? ": only mauvectl undo rolls back, since a rule made it"
                                 : ": a failure, or mauvectl undo, rolls back");
}

}  // namespace

std::string render_pending(const Json& status, Look look) {
  std::string text;
  const auto add = [&](const std::string& line) {
    text += painted(wrapped(harmless(line), look.width, 2), Paint::yellow, look.colour) + "\n";
  };
  if (const Json& locked = member(status, "locked"); locked.is_object()) {
    const auto reason = word(locked, "reason");
    add(word(status, "lock") + " locked by " + user_in_words(locked) + " at " +
        time_in_words(word(locked, "time")) + (reason.empty() ? "" : ": " + reason));
  }
  for (const Json& one : list_in(status, "probations")) add(sentence_of(one));
  for (const Json& one : list_in(status, "notes")) {
    add("note: " + word(one, "address") + " " + word(one, "text"));
  }
  for (const Json& one : list_in(status, "components")) {
    const auto name = word(one, "name");
    if (member(one, "stopped_by").is_string()) {
      add(name + ": " + word(one, "stopped_by") + "; only mauvectl start " + name +
          " starts it again");
    }
    if (const auto values = whole_number(one, "implausible"); values > 0) {
      add(name + ": " + counted(values, "value") + " of its present core " +
          (values > 1 ? "were" : "was") + " not plausible, so no reader gets " +
          (values > 1 ? "them" : "it") + ": mauvectl why " + name);
    }
  }
  for (const Json& one : list_in(status, "unknown_values")) {
    add(word(one, "address") + " is " + word(one, "text") + ": mauvectl rules");
  }
  for (const Json& one : list_in(status, "blocked_rules")) {
    const auto state = word(one, "state");
    const bool may_not = state == "held" || state == "limited";
    add("rule " + word(one, "rule") + " has no effect although its condition holds: " +
        (may_not ? word(one, "why_not") : word(one, "answer") + " (" + word(one, "why_not") + ")") +
        ": mauvectl rules");
  }
  if (const auto recovered = word(status, "recovered"); number(status, "recovered") > 0) {
    add("this run began with generation " + recovered +
        " after a crash or an upgrade, not with its file; to begin with the file: systemctl "
        "restart mauved, or mauved --fresh");
  }
  if (const double cores = number(status, "quarantine"); cores > 0) {
    add(counted(static_cast<std::size_t>(cores), "core") + (cores > 1 ? " are" : " is") +
        " in quarantine: mauvectl quarantine");
  }
  return text;
}

}  // namespace mauve::ctl
