// SPDX-License-Identifier: LGPL-3.0-or-later
/// Checks of the settings in force in mauved: versions, policy, guard, locked memory.
#include <algorithm>
#include <initializer_list>

#include "doctor/checks.h"
#include "mauve/host/version.h"
#include "render/words.h"

namespace mauve::ctl::doctor {
namespace {

using Cause = Finding (*)(const Facts&);

/// The remedy of the first of these checks that is not well. Where all are, mauved began before its
/// rights were granted.
std::string remedy_of(const Facts& facts, std::initializer_list<Cause> causes) {
  for (const Cause cause : causes) {
    const Finding found = facts.daemon.is_null() ? no_daemon() : cause(facts);
    if (found.grade != Grade::ok) return found.remedy;
  }
  return "restart mauved; if nothing changes, mauvectl logs --grep timing names the cause";
}

std::string remedy_of_policy(const Facts& facts) {
  return remedy_of(facts, {check_priority_of_daemon, check_group});
}

Finding off() {
  return doubt("mauved was started with --realtime off", "start it with --realtime prefer");
}

std::string machine_versions(const Facts& facts) {
  const std::string kernel = facts.kernel();
  return "kernel " + (kernel.empty() ? "unknown" : kernel) + ", glibc " + facts.glibc;
}

bool speaks(const Json& version) {
  const Json& spoken = list_in(version, "protocol");
  return std::find(spoken.begin(), spoken.end(), protocol::kVersion) != spoken.end();
}

}  // namespace

Finding check_daemon(const Facts& facts) {
  if (facts.status.is_null()) {
    return doubt("no daemon: " + facts.no_daemon,
                 facts.hint.empty() ? "mauved FILE, or systemctl start mauved" : facts.hint);
  }
  if (facts.daemon.is_null()) {
    return doubt("it does not say what it was granted: " + facts.no_daemon, facts.hint);
  }
  return good("answers on " + facts.socket + ", generation " + word(facts.status, "generation") +
              ", up " + seconds_in_words(number(facts.status, "uptime_s")));
}

Finding check_versions(const Facts& facts) {
  const std::string mine = "mauvectl " + facts.client + ", protocol " +
                           std::to_string(protocol::kVersion) + ", plugin ABI " +
                           std::to_string(kAbi) + ", " + machine_versions(facts);
  if (facts.version.is_null()) return good(mine);
  const std::string install = "install mauved and mauvectl of one version, then restart mauved";
  if (!speaks(facts.version) || whole_number(facts.version, "abi") != kAbi) {
    return bad("mauved " + word(facts.version, "version") + " has protocol " +
                   word(facts.version, "protocol") + " and plugin ABI " +
                   word(facts.version, "abi") + ", not those of " + mine +
                   ": commands may be refused",
               install);
  }
  if (word(facts.version, "version") != facts.client) {
    return doubt("mauved " + word(facts.version, "version") + ", but " + mine, install);
  }
  if (const auto glibc = word(facts.daemon, "glibc"); !glibc.empty() && glibc != facts.glibc) {
    return doubt("mauved runs with glibc " + glibc + ", but " + mine,
                 "restart mauved, which still has the library of before the upgrade");
  }
  return good("mauved and " + mine);
}

Finding check_policy(const Facts& facts) {
  if (facts.status.is_null()) return no_daemon();
  if (facts.asked_realtime() == "off") return off();
  std::string ordinary;
  for (const Json& row : facts.components()) {
    if (word(row, "realtime") == "true") continue;
    join(ordinary, word(row, "name"));
  }
  if (!ordinary.empty())
    return bad("without SCHED_FIFO: " + ordinary + ", so ordinary programs delay them",
               remedy_of_policy(facts));
  return good("SCHED_FIFO: " + counted(facts.components().size(), "component"));
}

Finding check_guard(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  if (facts.asked_realtime() == "off") return off();
  for (const Json& thread : list_in(facts.daemon, "threads")) {
    if (word(thread, "name") != "mauve-guard") continue;
    const std::string found = word(thread, "policy") + " " + word(thread, "priority");
    if (word(thread, "policy") == "SCHED_FIFO") return good(found);
    if (facts.components().empty()) return good(found + ", no component asks for more");
    return bad(found + ": a looping component keeps it from the processor",
               remedy_of_policy(facts));
  }
  if (facts.components().empty()) return good("no component, no guard");
  return bad("mauved has no thread mauve-guard: a job that hangs is not interrupted",
             "restart mauved");
}

Finding check_locked(const Facts& facts) {
  if (facts.daemon.is_null()) return no_daemon();
  if (facts.asked_realtime() == "off") return off();
  const auto locked = whole_number(facts.daemon, "locked_kib");
  if (locked > 0) return good(std::to_string(locked / 1024) + " MiB of mauved are locked");
  return bad("nothing of mauved is locked: page faults stop components",
             remedy_of(facts, {check_locking_of_daemon}));
}

Finding check_guardian(const Facts& facts) {
  if (facts.status.is_null()) return no_daemon();
  const auto guardian = facts.status.find("guardian");
  if (guardian == facts.status.end() || !guardian->is_object()) {
    return good("no output asks for a guardian");
  }
  std::string outputs;
  for (const Json& name : list_in(*guardian, "outputs")) join(outputs, name.get<std::string>());
  if (word(*guardian, "present") != "true") {
    return bad("no guardian holds " + outputs +
                   ", which stay as they are should mauved be killed: " + word(*guardian, "why"),
               "systemctl start mauve-guardian");
  }
  if (word(*guardian, "service") == "true") return good("a service holds " + outputs);
  return doubt("mauved started the guardian of " + outputs +
                   " itself: what ends all processes of its service ends both",
               "systemctl start mauve-guardian, then restart mauved");
}

}  // namespace mauve::ctl::doctor
