// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/former.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "changes/control.h"
#include "commands/command.h"
#include "mauve/host/retired.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using plugin::Library;

/// Threads reach a quiescent point within one job, unless one hangs: then the code stays, and the
/// log reports it.
constexpr std::chrono::seconds kPatience{2};

bool ends_a_probation(const Outcome& outcome) {
  return outcome.kind == Outcome::Kind::passed || outcome.kind == Outcome::Kind::overtaken ||
         outcome.kind == Outcome::Kind::rolled_back;
}

/// "/usr/lib/mauve/plugins/slip.so held build fa032653 at the reload, and the next start or reload
/// of slip loads this file: put build 9651293e in its place"
std::string on_file(const plugin::PluginInfo& undone, const plugin::PluginInfo& former) {
  if (undone.build_id == former.build_id) {
    return "its file held the same build at the reload";
  }
  return undone.file + " held build " + short_build(undone.build_id) +
         " at the reload, and the next start or reload of " + undone.name +
         " loads this file: put build " + short_build(former.build_id) + " in its place";
}

/// The former build has its names again, and the code that loses them is let go.
void restore_names(Running& running, plugin::LoadedPlugin former) {
  const auto info = former.info();
  auto failed = running.catalog.exchange(std::move(former));
  if (!failed || !*failed) {
    running.log.write(
        Event::plugin_resident,
        {{"plugin", info.name}, {"text", failed ? "its names are gone" : failed.error().message}});
    return;
  }
  running.log.write(Event::plugin_given_back, {{"plugin", info.name},
                                               {"version", info.version},
                                               {"build", info.build_id},
                                               {"text", on_file((*failed)->info(), info)}});
  let_go(running, (*failed)->library(), "its reload was rolled back");
}

}  // namespace

Event event_of(const plugin::Unmapped& code) {
  if (code.unmapped) {
    return Event::plugin_unloaded;
  }
  return code.types_only ? Event::plugin_types_used : Event::plugin_resident;
}

void clean_up(Running& running, Retired& retired) {
  const auto cleaned = retired.release();
  if (!cleaned) {
    running.log.write(logging::Event::clean_up_failed,
                      {{"component", cleaned.error().at}, {"text", to_string(cleaned.error())}});
  }
}

Status check_former(const Running& running, const std::string& plugin) {
  MAUVE_ON_THREAD(control);
  const auto found = running.former.kept.find(plugin);
  if (found == running.former.kept.end()) {
    return ok();
  }
  return refuse({Errc::conflict, "build_on_probation"}, plugin,
                "was reloaded in generation " + std::to_string(found->second.generation) +
                    ", which is on probation: the build before is kept for its rollback, and one "
                    "only can be kept",
                "mauvectl confirm, or mauvectl undo, then reload again");
}

void let_go(Running& running, std::shared_ptr<Library> library, std::string text) {
  MAUVE_ON_THREAD(control);
  running.former.leaving.push_back(
      {std::move(library), std::chrono::steady_clock::now(), std::move(text)});
}

void keep_former(Running& running, std::uint64_t generation, plugin::LoadedPlugin former) {
  MAUVE_ON_THREAD(control);
  const std::string name = former.info().name;
  running.former.kept.insert_or_assign(name, Former::Kept{generation, std::move(former)});
}

std::vector<std::string> notes_on_files(const Running& running,
                                        const std::vector<std::uint64_t>& changes) {
  MAUVE_ON_THREAD(control);
  std::vector<std::string> notes;
  for (const auto& [name, kept] : running.former.kept) {
    const auto* undone = running.catalog.find(name);
    const bool goes = std::ranges::find(changes, kept.generation) != changes.end();
    if (goes && undone != nullptr && undone->info().build_id != kept.plugin.info().build_id) {
      notes.push_back("an undo changes no file: " + on_file(undone->info(), kept.plugin.info()));
    }
  }
  return notes;
}

Builds builds_after(const Running& running, const Outcome& outcome) {
  MAUVE_ON_THREAD(control);
  auto builds = builds_of(running.catalog);
  if (outcome.kind != Outcome::Kind::rolled_back) {
    return builds;
  }
  for (const auto& [name, kept] : running.former.kept) {
    if (std::ranges::find(outcome.generations, kept.generation) != outcome.generations.end()) {
      builds[name] = kept.plugin.info().build_id;
    }
  }
  return builds;
}

void let_former_go(Running& running, const Outcome& outcome) {
  MAUVE_ON_THREAD(control);
  if (!ends_a_probation(outcome)) {
    return;
  }
  auto& kept = running.former.kept;
  for (auto one = kept.begin(); one != kept.end();) {
    if (std::ranges::find(outcome.generations, one->second.generation) ==
        outcome.generations.end()) {
      ++one;
      continue;
    }
    auto former = std::move(one->second.plugin);
    one = kept.erase(one);
    if (outcome.kind == Outcome::Kind::rolled_back) {
      restore_names(running, std::move(former));
    } else {
      let_go(running, former.library(), "replaced by a new one, which has proved itself");
    }
  }
}

void free_former(Running& running) {
  auto& leaving = running.former.leaving;
  if (leaving.empty()) {
    return;
  }
  const bool patient = std::chrono::steady_clock::now() - leaving.front().since < kPatience;
  if (!running.deployer.settled() && patient) {
    return;
  }
  auto elements = std::make_shared<Retired>(running.deployer.collect());
  auto code = std::make_shared<std::vector<Former::Leaving>>(std::exchange(leaving, {}));
  running.control.in_factory(
      [&running, elements, code] {
        static_cast<void>(elements->release());
        running.log.flush();  // messages of the code are text in the code
        for (auto& one : *code) {
          const auto name = one.library->info().name;
          const auto done = Library::release(std::move(one.library));
          running.log.write(event_of(done),
                            {{"plugin", name}, {"text", done.unmapped ? one.text : done.reason}});
        }
      },
      [] {}, [](const std::string& /*hook*/) {});
}

}  // namespace mauve::daemon
