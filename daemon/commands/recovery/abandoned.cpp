// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/abandoned.h"

#include "base/thread_role.h"

#include <algorithm>
#include <cstddef>

#include "base/duration.h"
#include "commands/lock.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

/// Each keeps a thread and a library: a client that tries again and again shall not use them up.
constexpr std::size_t kMostAbandoned = 8;
constexpr std::ptrdiff_t kMostOfOneUser = 2;

Status check_name(const Running& running, const std::string& name) {
  const auto found = running.abandoned_in.find(name);
  if (found == running.abandoned_in.end()) {
    return ok();
  }
  return refuse({Errc::wrong_state, "component_abandoned"}, name,
                "cannot be changed any more: mauved abandoned a thread that did not return from " +
                    found->second,
                "restart mauved");
}

}  // namespace

Error thread_abandoned(const Running& running, const std::string& hook, const std::string& at,
                       const std::string& now) {
  MAUVE_ON_THREAD(control);
  const auto space = hook.find(' ');
  const bool placed = space != std::string::npos;
  return refuse(
      {Errc::timed_out, "hook_did_not_return"}, placed ? hook.substr(0, space) : at,
      (placed         ? hook.substr(space + 1)
       : hook.empty() ? "user code"
                      : hook) +
          " did not return within " + format_duration(running.control.prepare_within()) +
          ", so mauved abandoned its thread: " + now,
      "the abandoned thread keeps its library in memory until mauved is restarted: correct "
      "the function, or give it longer with mauved --prepare-within");
}

void note_abandoned_in(Running& running, const std::vector<std::string>& components,
                       const std::string& hook, bool all) {
  MAUVE_ON_THREAD(control);
  for (const auto& name : components) {
    const auto* component = running.architecture.find_component(name);
    const bool whole = component != nullptr && component->shell().configured() &&
                       component->core().configured() && component->fsm().configured();
    if (component != nullptr && (all || !whole)) {
      running.abandoned_in.emplace(name, hook.empty() ? "user code" : hook);
    }
  }
}

Status check_abandoned_in(const Running& running, const Change& change) {
  MAUVE_ON_THREAD(control);
  if (only_stops(change)) {
    return ok();
  }
  for (const auto& edit : change.edits) {
    if (auto allowed = check_name(running, edit.member); !allowed) {
      return allowed;
    }
  }
  for (const auto& name : change.remove) {
    if (auto allowed = check_name(running, name); !allowed) {
      return allowed;
    }
  }
  return ok();
}

Status may_prepare(const std::vector<AbandonedThread>& left, std::optional<uid_t> user) {
  const auto of_user = std::ranges::count(left, user, &AbandonedThread::user);
  if (user && of_user >= kMostOfOneUser) {
    return refuse(
        {Errc::wrong_state, "hooks_hang"}, "mauved",
        std::to_string(of_user) +
            " hooks of changes of yours have not returned, so no other change of yours is "
            "prepared; the components run on",
        "`status` names the hooks; wait until they return, or correct them and restart "
        "mauved");
  }
  if (left.size() < kMostAbandoned) {
    return ok();
  }
  return refuse(
      {Errc::wrong_state, "hooks_hang"}, "mauved",
      std::to_string(left.size()) +
          " threads are abandoned in hooks that did not return, so no change is prepared; "
          "the components run on",
      "`status` names the hooks; correct them, then restart mauved");
}

Status may_prepare_change(const Running& running, const Change& change, std::optional<uid_t> user) {
  return only_stops(change) ? ok() : may_prepare(running.control.abandoned_threads(), user);
}

std::string listed(const std::vector<std::string>& components,
                   const std::vector<AbandonedThread>& hooks) {
  std::string text;
  for (const auto& name : components) {
    text += (text.empty() ? "" : ", ") + name;
  }
  for (const auto& left : hooks) {
    text += (text.empty() ? "the hook " : ", the hook ") + left.hook;
  }
  return text;
}

Json abandoned_threads(const Running& running) {
  MAUVE_ON_THREAD(control);
  Json rows = Json::array();
  for (const auto& one : running.control.abandoned_threads()) {
    rows.push_back({{"hook", one.hook}, {"since", logging::utc(one.since)}});
  }
  return rows;
}

}  // namespace mauve::daemon
