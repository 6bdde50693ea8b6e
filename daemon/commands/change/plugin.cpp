// SPDX-License-Identifier: LGPL-3.0-or-later
/// plugin.load and plugin.unload: code comes and goes while the robot moves.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "commands/answer.h"

#include "base/thread_role.h"
#include "commands/change/change.h"
#include "commands/change/plugin_members.h"
#include "commands/change/trial.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/former.h"
#include "commands/say.h"
#include "start_warnings.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using plugin::Library;
using plugin::LoadedPlugin;

struct Load {
  std::string name;
  std::optional<Result<LoadedPlugin>> loaded;
};

void finish_load(Running& running, const Call& call, Load& load) {
  const FromLookToAct still(running);
  if (!*load.loaded) {
    return answer(running, call, load.loaded->error());
  }
  if (auto met = check_conditions(running, call); !met) {
    return answer(running, call, met.error());
  }
  const auto info = (*load.loaded)->info();
  const std::vector lines = {arch::make_line("plugin", info.name, {}, info.name)};
  if (auto allowed = may_change(running, call, lines); !allowed) {
    return answer(running, call, allowed.error());
  }
  if (flag(call.params, "dry_run")) {
    Json planned{{"plugin", info.name},
                 {"version", info.version},
                 {"warnings", info.warnings},
                 {"dry_run", true},
                 {"generation", running.generation.load()}};
    say_lines(lines, planned);
    return answer(running, call, std::move(planned));
  }
  auto done = running.catalog.commit(std::move(**load.loaded));
  if (!done) {
    return answer(running, call, done.error());
  }
  log_loaded(running.log, info);
  Json result{{"plugin", info.name},
              {"version", info.version},
              {"warnings", info.warnings},
              {"loaded", true},
              {"unmapped", nullptr},
              {"why", ""},
              {"generation", running.generation.load()}};
  say_lines(lines, result);
  answer(running, call, std::move(result));
}

arch::Line line_of_unloading(const std::string& name) {
  return arch::make_line("plugin", name, name, {});
}

void finish_unload(Running& running, const Call& call, const std::string& name,
                   const plugin::Unmapped& unmapped) {
  running.log.write(
      event_of(unmapped),
      {{"plugin", name}, {"text", unmapped.unmapped ? "by request" : unmapped.reason}});
  Json result{{"plugin", name},
              {"loaded", false},
              {"unmapped", unmapped.unmapped},
              {"why", unmapped.reason},
              {"generation", running.generation.load()}};
  say_lines({line_of_unloading(name)}, result);
  answer(running, call, std::move(result));
}

/// A transaction or a rule puts a core of the plugin in place: without it these steps are refused.
Status check_named_in_steps(const Running& running, const std::string& plugin) {
  const auto check = [&plugin](const std::string& at, const rules::Steps& steps) {
    const auto swap = std::ranges::find_if(steps, [&plugin](const rules::Step& step) {
      return step.action == rules::Action::swap && plugin_of(step.object) == plugin;
    });
    return swap == steps.end() ? ok()
                               : Status(refuse({Errc::wrong_state, "plugin_in_use"}, plugin,
                                               at + " swaps " + swap->subject + " to " +
                                                   swap->object + ", which only this plugin has",
                                               "mauvectl apply a file without these steps first"));
  };
  const auto& supervision = running.supervisor.supervision();
  auto unused = ok();
  for (const auto& [name, steps] : supervision.transactions) {
    unused = unused ? check("transaction " + name, steps) : unused;
  }
  for (const auto& rule : supervision.rules) {
    unused = unused ? check("rule " + rule.name, rule.steps) : unused;
  }
  return unused;
}

/// The users that the error names may be kept for a rollback only, and run no more.
Error why_in_use(const Running& running, const std::string& plugin, Error error) {
  const bool in_force = !members_of(running, plugin, StatePolicy::keep).edits.empty();
  if (error.code != Errc::wrong_state || !running.deployer.on_probation() || in_force) {
    return error;
  }
  error.message += ", which does not run any more: it is kept for the rollback until generation " +
                   std::to_string(running.generation.load()) + " has proved itself";
  error.hint = "mauvectl confirm ends that at once";
  return error;
}

/// [control] It did no harm elsewhere.
void load_in_factory(Running& running, const CallPtr& call, const std::shared_ptr<Load>& load,
                     Ticket ticket) {
  MAUVE_ON_THREAD(control);
  running.control.in_factory(
      [&running, load] { load->loaded = running.catalog.prepare_load(load->name); },
      [&running, call, load, ticket = std::move(ticket)] {
        finish_load(running, *call, *load);
        // A plugin that was refused is unmapped where it was mapped.
        running.control.in_factory([load] { load->loaded.reset(); }, [ticket] {});
      },
      [&running, call, name = load->name](const std::string& hook) {
        answer(running, *call, thread_abandoned(running, hook, name));
      });
}

}  // namespace

void load_plugin(Running& running, const CallPtr& call, Ticket ticket) {
  auto load = std::make_shared<Load>();
  load->name = text_or(call->params, "plugin");
  if (const auto* there = running.catalog.find(load->name)) {
    return answer(running, *call,
                  refuse({Errc::duplicate, "plugin_loaded_already"}, load->name,
                         "is loaded already, version " + there->info().version,
                         "mauvectl reload " + load->name + " takes the file of now"));
  }
  try_out(running, call, question_of_plugin(load->name), load->name,
          [&running, call, load, ticket = std::move(ticket)] {
            load_in_factory(running, call, load, ticket);
          });
}

namespace {

/// [control] No remains of the changes before this one hold the library any more.
void unload_settled(Running& running, const CallPtr& call, const std::string& name, Ticket ticket) {
  const FromLookToAct still(running);
  auto allowed = check_conditions(running, *call);
  if (allowed) {
    allowed = may_change(running, *call, {line_of_unloading(name)});
  }
  if (allowed) {
    allowed = check_named_in_steps(running, name);
  }
  if (!allowed) {
    return answer(running, *call, allowed.error());
  }
  auto library = running.catalog.remove(name);
  if (!library) {
    return answer(running, *call, why_in_use(running, name, library.error()));
  }
  auto unmapped = std::make_shared<plugin::Unmapped>();
  running.control.in_factory(
      [&running, unmapped, library = *std::move(library)]() mutable {
        running.log.flush();  // its messages are text in its code
        *unmapped = Library::release(std::move(library));
      },
      [&running, call, name, unmapped, ticket = std::move(ticket)] {
        finish_unload(running, *call, name, *unmapped);
      },
      [&running, call, name](const std::string& /*none*/) {
        finish_unload(running, *call, name, {false, "an abandoned thread is still in it"});
      });
}

}  // namespace

/// Cores that were replaced just now hold their library until their threads have passed a quiescent
/// point and [factory] has freed them. That takes moments, unless a thread hangs.
void unload_plugin(Running& running, const CallPtr& call, Ticket ticket) {
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  running.control.await(
      [&running, patience] {
        return running.deployer.settled() || std::chrono::steady_clock::now() > patience;
      },
      [&running, call, ticket = std::move(ticket)]() mutable {
        auto retired = std::make_shared<Retired>(running.deployer.collect());
        running.control.in_factory(
            [&running, retired] { clean_up(running, *retired); },
            [&running, call, ticket = std::move(ticket)]() mutable {
              unload_settled(running, call, text_or(call->params, "plugin"), std::move(ticket));
            },
            [&running, call](const std::string& hook) {
              answer(running, *call,
                     thread_abandoned(running, hook, text_or(call->params, "plugin")));
            });
      });
}

}  // namespace mauve::daemon
