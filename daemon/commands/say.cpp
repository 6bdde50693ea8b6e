// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/say.h"

#include <algorithm>

#include "base/thread_role.h"

#include "commands/change/change.h"
#include "commands/recovery/quarantine.h"
#include "exec/system/prepared.h"
#include "judge/judgement.h"
#include "mauve/fsm.h"

namespace mauve::daemon {

namespace {

/// The time in which each member runs so many jobs on its grid; none: one does not run, or has no
/// grid.
std::optional<Duration> time_of_jobs(const Running& running, std::uint64_t jobs,
                                     PreparedChange& change) {
  std::optional<Duration> longest;
  for (const auto& member : change.content().members) {
    const auto grid = member.next == nullptr ? Duration{0} : member.next->fsm->grid();
    const auto state = running.deployer.status(member.component->name()).state;
    if (grid <= Duration{0} || state != ComponentState::running) {
      return std::nullopt;
    }
    longest = std::max(longest.value_or(grid), grid);
  }
  return longest ? std::optional(*longest * static_cast<std::int64_t>(jobs)) : std::nullopt;
}

}  // namespace

void say_lines(const std::vector<arch::Line>& lines, Json& result) {
  if (lines.empty() || result.contains("lines")) {
    return;
  }
  auto& said = result["lines"] = Json::array();
  for (const auto& line : lines) {
    said.push_back(to_json(line));
  }
}

void expect_lines(Running& running, const std::shared_ptr<const Ongoing>& change,
                  const std::vector<arch::Line>& lines) {
  MAUVE_ON_THREAD(control);
  Json foreseen;
  say_lines(lines, foreseen);
  running.rollback_lines.expect(change, std::move(foreseen["lines"]));
}

void remember_lines(Running& running, std::uint64_t made, const std::vector<arch::Line>& lines) {
  MAUVE_ON_THREAD(control);
  Json done;
  say_lines(lines, done);
  if (made != 0) {
    running.rollback_lines.remember(made, done["lines"]);
  }
}

void say_notes(const std::vector<std::string>& notes, Json& result) {
  for (const auto& note : notes) {
    result["notes"].push_back(note);
  }
}

void say_same_build(const std::vector<arch::Line>& lines, Json& result) {
  if (!lines.empty() && lines.front().before == lines.front().after) {
    say_notes({"the file has the build that runs already, so the code is the same; everything of "
               "the plugin is made anew"},
              result);
  }
}

void say_sync(std::optional<Result<PreparedChange>>& prepared, Json& result) {
  if (prepared && *prepared && (*prepared)->content().barrier) {
    result["sync"] = "barrier";
  }
}

void say_probation(const Running& running, const Probation& probation,
                   std::optional<Result<PreparedChange>>& prepared, Json& result) {
  MAUVE_ON_THREAD(control);
  auto& rules = result["probation"] = to_json(probation);
  if (probation.confirm_within > Duration{0} || !prepared || !*prepared) {
    return;
  }
  const auto jobs = time_of_jobs(running, probation.activations, **prepared);
  if (jobs && *jobs < probation.time) {
    rules["jobs_ns"] = jobs->count();
  }
}

void say_missed(bool realtime, Json& result) {
  const auto& members = result["components"];
  const bool missed = std::any_of(members.begin(), members.end(),
                                  [](const Json& one) { return one.value("missed", 0) > 0; });
  if (missed && !realtime) {
    result["ordinary_threads"] = true;
  }
}

void say_who_stands(Running& running, const Change& change, Asked asked, Json& result) {
  MAUVE_ON_THREAD(control);
  auto standing = Json::array();
  for (const auto& edit : change.edits) {
    auto now = running.deployer.status(edit.member);
    if (edit.core) {
      now.core = edit.core->name;  // the next step is for the new core, in a dry run too
    }
    const bool would_start = asked == Asked::dry_run && edit.mode == Mode::run;
    const bool recovers = now.state == ComponentState::recovering;
    const bool stands =
        recovers || now.state == ComponentState::faulted || now.state == ComponentState::stopped;
    if (edit.mode != Mode::park && !would_start && !now.name.empty() && stands) {
      standing.push_back(
          {{"name", now.name},
           {"state", to_string(now.state)},
           {"hint", recovers ? "mauvectl why " + now.name : step_to_run(running, now)}});
    }
  }
  if (!standing.empty()) {
    result["standing"] = std::move(standing);
  }
}

std::vector<std::string> notes_on_starts(const std::vector<arch::Line>& lines,
                                         const std::string& source, bool dry_run) {
  std::vector<std::string> notes;
  for (const auto& line : lines) {
    if (line.kind == "start" && line.before == Value(false) && line.after == Value(true)) {
      notes.push_back(line.address.substr(0, line.address.find('.')) + " " +
                      (dry_run ? "will start" : "starts") + ": it was stopped, and " + source +
                      " has it running");
    }
  }
  return notes;
}

}  // namespace mauve::daemon
