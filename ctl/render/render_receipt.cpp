// SPDX-License-Identifier: LGPL-3.0-or-later
/// The answer to a change.
#include <algorithm>
#include <string>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

/// ", on probation for 3000 jobs or 10 s"; ", on probation for 3000 jobs or 10 s, about 6 s"
std::string on_probation(const Json& receipt) {
  const Json& probation = member(receipt, "probation");
  if (!probation.is_object()) return {};
  if (const double confirm = number(probation, "confirm_within_ns"); confirm > 0) {
    return ", to be confirmed within " + nanoseconds_in_words(confirm);
  }
  const std::string jobs =
      ", on probation for " + counted(whole_number(probation, "activations"), "job");
  constexpr double kWholeDay = 86'400e9;  // in place of none
  const double time = number(probation, "time_ns");
  const double until_jobs = number(probation, "jobs_ns");
  return jobs + (time >= kWholeDay ? "" : " or " + nanoseconds_in_words(time)) +
         (until_jobs > 0 ? ", about " + nanoseconds_in_words(until_jobs) : "");
}

/// One line for each entry of a list of the receipt.
template <typename F>
std::string lines_of(const Json& receipt, const char* list, Look look, const F& line) {
  std::string text;
  for (const Json& one : list_in(receipt, list)) {
    text += wrapped("  " + line(one), look.width, 4) + "\n";
  }
  return text;
}

/// The lines of the change state the values.
std::string defaults(const Json& receipt, Look look) {
  std::string names;
  for (const Json& one : list_in(receipt, "defaults")) join(names, word(one, "name"));
  if (names.empty()) return {};
  const bool one = list_in(receipt, "defaults").size() == 1;
  return wrapped("  " + names + (one ? " has its default value" : " have their default values") +
                     "; --set NAME=VALUE keeps another",
                 look.width, 4) +
         "\n";
}

/// "  bypass (true) is gone: the new core has no such property"
std::string gone(const Json& receipt, Look look) {
  return lines_of(receipt, "gone", look, [](const Json& one) {
    return word(one, "name") + " (" + word(one, "before") +
           ") is gone: the new core has no such property";
  });
}

/// "  mission.core.goal.y keeps 0: the value given does not name it"
std::string kept(const Json& receipt, Look look) {
  return lines_of(receipt, "kept", look, [](const Json& one) {
    return word(one, "address") + " keeps " + word(one, "value") +
           ": the value given does not name it";
  });
}

/// "  control: its state pi_state/2 (24 bytes) is dropped", one a line.
std::string dropped(const Json& receipt, Look look) {
  std::string text;
  for (const Json& one : list_in(receipt, "components")) {
    const std::string state = word(one, "dropped");
    if (state.empty()) continue;
    text += wrapped("  " + word(one, "name") + ": its state " + state + " (" +
                        counted(whole_number(one, "dropped_bytes"), "byte") + ") is dropped",
                    look.width, 4) +
            "\n";
  }
  return text;
}

/// "laser, gnss: running already".
std::string already_so(const Json& receipt, Look look) {
  std::string names;
  for (const Json& name : list_in(receipt, "already")) join(names, harmless(compact(name)));
  if (names.empty()) return {};
  return wrapped("  " + names + ": " + word(receipt, "already_state") + " already", look.width, 4) +
         "\n";
}

/// "control is faulted and does not run: mauvectl start control", one a line.
std::string standing(const Json& receipt, Look look) {
  std::string text;
  for (const Json& one : list_in(receipt, "standing")) {
    const std::string line =
        word(one, "name") + " is " + word(one, "state") + " and does not run: " + word(one, "hint");
    text += painted(wrapped(line, look.width, 2), Paint::yellow, look.colour) + "\n";
  }
  return text;
}

/// "  the old code stays in memory: a thread is still in it"
std::string old_code(const Json& receipt, Look look) {
  const std::string why = word(receipt, "why");
  if (word(receipt, "unmapped") != "false" || why.empty()) return {};
  return wrapped("  the old code stays in memory: " + why, look.width, 4) + "\n";
}

/// "warning: control: its job may never end", one a line; those of a plugin begin with its name.
std::string warnings(const Json& receipt, Look look) {
  const std::string plugin = word(receipt, "plugin");
  const std::string subject = "warning: " + (plugin.empty() ? "" : plugin + ": ");
  std::string text;
  for (const Json& warning : list_in(receipt, "warnings")) {
    const std::string line = subject + harmless(compact(warning));
    text += painted(wrapped(line, look.width, 2), Paint::yellow, look.colour) + "\n";
  }
  return text;
}

/// ", 16 bytes of state kept, state converted: count/1 -> count/2, Stateless, so begun anew: lamp"
std::string kept_states(const Json& receipt) {
  std::uint64_t bytes = 0;
  std::string converted;
  std::string anew;
  for (const Json& one : list_in(receipt, "components")) {
    const std::string types = word(one, "converted");
    if (types.empty()) bytes += whole_number(one, "bytes");
    if (!types.empty()) converted += ", state converted: " + types;
    if (member(one, "begins_anew") == true) join(anew, word(one, "name"));
  }
  return (bytes > 0 ? ", " + counted(bytes, "byte") + " of state kept" : "") + converted +
         (anew.empty() ? "" : ", Stateless, so begun anew: " + anew);
}

}  // namespace

std::string note_lines(const Json& receipt, Look look) {
  std::string text;
  for (const Json& note : list_in(receipt, "notes")) {
    text += wrapped("note: " + harmless(compact(note)), look.width, 2) + "\n";
  }
  return text;
}

std::string remark_lines(const Json& receipt, Look look) {
  return already_so(receipt, look) + defaults(receipt, look) + gone(receipt, look) +
         kept(receipt, look) + dropped(receipt, look) + standing(receipt, look) +
         old_code(receipt, look) + note_lines(receipt, look) + warnings(receipt, look);
}

std::string render_receipt(std::string_view done, const Json& receipt, Look look) {
  const std::string generation = word(receipt, "generation");
  if (member(receipt, "changed") == false) {
    return "nothing to change (generation " + generation + " still running)\n" +
           remark_lines(receipt, look);
  }
  const Json& components = member(receipt, "components");
  std::string text(done);
  double pause = 0;
  std::uint64_t missed = 0;
  for (const Json& one : components) {
    pause = std::max(pause, number(one, "pause_ns"));
    missed += whole_number(one, "missed");
  }
  if (!components.empty()) {
    text += components.size() > 1 ? ": longest pause " : ": pause ";
    text += nanoseconds_in_words(pause) + ", " + counted(missed, "release") + " missed";
    if (member(receipt, "ordinary_threads") == true) {
      text += " meanwhile, on ordinary threads that the machine delays too: mauvectl doctor";
    }
  }
  text += kept_states(receipt);
  const auto attempts = whole_number(receipt, "attempts");
  if (attempts > 1) text += ", " + counted(attempts, "attempt");
  text += " (generation " + generation + on_probation(receipt);
  if (member(receipt, "saved") == false) text += ", applied but NOT saved";
  text += ")";
  if (const auto held = whole_number(receipt, "rules_held"); held > 0) {
    text += ", " + counted(held, "rule") + (held == 1 ? " is held" : " are held");
    std::string names;
    for (const Json& rule : member(receipt, "held_rules")) join(names, harmless(compact(rule)));
    if (!names.empty()) text += ": " + names;
  }
  return wrapped(text, look.width, 2) + "\n" + remark_lines(receipt, look);
}

}  // namespace mauve::ctl
