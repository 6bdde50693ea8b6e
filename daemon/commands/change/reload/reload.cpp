// SPDX-License-Identifier: LGPL-3.0-or-later
/// plugin.reload: everything that components run, and all resources, move to the new code in one
/// transaction. The old code stays in memory while the change is on probation (see former.h);
/// without a probation it is unmapped at once, or the answer gives the reason why not.
///
///   [judge]   make everything that runs from the new file in a process of its own.
///   [factory] map the new file, make and configure the new elements.
///   [control] give the names to the new code, and swap all members; with resources at a barrier.
///   [factory] without a probation: clean up and free the old elements, and unmap the old code.
#include <algorithm>
#include <iterator>
#include <optional>

#include "arch/text/value_json.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/change/change_request.h"
#include "commands/change/plugin_members.h"
#include "commands/change/policies.h"
#include "commands/change/reload/reload_answer.h"
#include "commands/change/reload/reload_in_place.h"
#include "commands/change/trial.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/former.h"
#include "commands/recovery/quarantine.h"
#include "commands/recovery/unproven.h"
#include "commands/say.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using plugin::Library;
using plugin::LoadedPlugin;

struct Reload {
  std::string name;
  Change change;  ///< [factory] fills in the types, see take_new_types()
  std::optional<Result<LoadedPlugin>> loaded;
  std::optional<Result<PreparedChange>> prepared;
  Retired retired;
  std::optional<Receipt> receipt;
  std::optional<LoadedPlugin> old;
  plugin::Unmapped unmapped;
  std::vector<arch::Line> lines;  ///< the differences that it makes, once it is prepared
  std::vector<std::string> notes;
  std::shared_ptr<ReloadAnswer> answer;  ///< once it is in force
};
using ReloadPtr = std::shared_ptr<Reload>;

/// [factory]
void prepare(Running& running, Reload& reload) {
  reload.loaded = running.catalog.prepare_load(reload.name);
  if (!*reload.loaded) {
    reload.prepared = reload.loaded->error();
    return;
  }
  if (auto found = take_new_types(**reload.loaded, reload.change); !found) {
    reload.prepared = found.error();
    return;
  }
  if (!reload.change.edits.empty()) {
    reload.prepared = running.deployer.prepare(reload.change);
  }
}

/// [control]
std::vector<arch::Line> lines_of_reload(const Running& running, Reload& reload) {
  std::vector<arch::Line> lines = {line_of_build(running, **reload.loaded)};
  if (reload.prepared) {
    std::ranges::move(lines_of(running, **reload.prepared), std::back_inserter(lines));
  }
  return lines;
}

/// [control] Makes all checks that may refuse the new code, before anything changes.
Status may_go_on(Running& running, const Call& call, Reload& reload) {
  if (reload.prepared && !*reload.prepared) {
    return reload.prepared->error();
  }
  if (auto met = check_conditions(running, call); !met) {
    return met;
  }
  const auto build_of = [&](const std::string&) { return (*reload.loaded)->info().build_id; };
  if (auto allowed = check_quarantine(running, reload.change, build_of); !allowed) {
    return allowed;
  }
  if (auto good = running.catalog.check_types(**reload.loaded); !good) {
    return good;
  }
  if (auto kept = running.catalog.check_types_in_use(**reload.loaded); !kept) {
    return kept;
  }
  reload.lines = lines_of_reload(running, reload);
  if (reload.prepared) {
    reload.notes = notes_on_lost_names(running, **reload.prepared);
  }
  return may_change(running, call, reload.lines);
}

/// [control] The names change hands last, since that cannot be undone.
Status hand_names_over(Running& running, Reload& reload) {
  auto old = running.catalog.exchange(std::move(**reload.loaded));
  if (!old) {
    return old.error();
  }
  if (reload.change.probation && reload.receipt && *old) {
    keep_former(running, reload.receipt->generation, **std::move(old));
    reload.unmapped = {false, "it is kept until the probation of generation " +
                                  std::to_string(reload.receipt->generation) + " ends"};
    return ok();
  }
  reload.old = *std::move(old);
  return ok();
}

/// [factory] Messages of the old code are text in the old code: they are reported before it is
/// unloaded.
void free_old(Running& running, Reload& reload, bool in_force) {
  clean_up(running, reload.retired);
  reload.prepared.reset();
  reload.change = {};  // the new types, and with them their library
  reload.loaded.reset();
  if (in_force && reload.old) {
    running.log.flush();
    auto library = reload.old->library();
    reload.old.reset();
    reload.unmapped = Library::release(std::move(library));
  }
}

/// The receipt of a reload that is in force. It names the generation of the reload, although a
/// rollback may have begun another.
Json result_of(Running& running, Reload& reload) {
  auto result = to_json(reload.receipt.value_or(Receipt{running.generation, {}, {}, 0, {}}));
  say_sync(reload.prepared, result);
  say_who_stands(running, reload.change, Asked::in_force, result);
  say_missed(running.deployer.realtime(), result);
  say_lines(reload.lines, result);
  say_same_build(reload.lines, result);
  say_notes(reload.notes, result);
  if (reload.receipt && reload.change.probation) {
    say_probation(running, *reload.change.probation, reload.prepared, result);
  }
  result["changed"] = true;
  result["state"] = "applied";
  result["plugin"] = reload.name;
  result["loaded"] = true;
  return result;
}

/// [control] The names mean the new code from now on, and the reload is in the books.
Status put_in_books(Running& running, const CallPtr& call, Reload& reload) {
  if (auto handed = hand_names_over(running, reload); !handed) {
    return handed;
  }
  reload.answer = std::make_shared<ReloadAnswer>(call->reply);
  auto booked = *call;  // a deadline may answer the call itself meanwhile
  booked.reply = [whole = reload.answer](server::Outcome receipt) {
    whole->receipt(std::move(receipt));
  };
  answer(running, booked, result_of(running, reload));
  return ok();
}

void finish(Running& running, const std::string& plugin, ReloadAnswer& whole,
            const plugin::Unmapped& old, bool kept) {
  running.log.write(kept && !old.unmapped ? Event::plugin_kept : event_of(old),
                    {{"plugin", plugin},
                     {"text", old.unmapped ? std::string("replaced by a new one") : old.reason}});
  whole.old_code(old);
}

/// [control] A refusal is answered at once, a reload in force when the old code is gone.
void end(Running& running, const CallPtr& call, ReloadPtr reload, Ticket ticket,
         const Status& done) {
  if (!done) {
    answer(running, *call, done.error(), state_after(done.error()));
  }
  const auto whole = reload->answer;
  const bool kept = reload->receipt && reload->change.probation;
  running.control.in_factory(
      [&running, reload, whole] { free_old(running, *reload, whole != nullptr); },
      [&running, call, reload, whole, kept, ticket = std::move(ticket)] {
        if (whole != nullptr) {
          finish(running, reload->name, *whole, reload->unmapped, kept);
        }
      },
      [&running, call, plugin = reload->name, whole, kept](const std::string& hook) {
        if (whole != nullptr) {
          finish(running, plugin, *whole,
                 {false, "an abandoned thread is still in it" + (hook.empty() ? "" : ": " + hook)},
                 kept);
        }
      });
}

/// [control] Waits for the last users of the old code: a probation that this change ended, a core
/// that stood by. Threads reach their quiescent points at once, unless one hangs.
void end_when_settled(Running& running, const CallPtr& call, ReloadPtr reload, Ticket ticket,
                      const Status& done) {
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  running.control.await(
      [&running, patience] {
        return running.deployer.settled() || std::chrono::steady_clock::now() > patience;
      },
      [&running, call, reload, ticket = std::move(ticket), done]() mutable {
        reload->retired.merge(running.deployer.collect());
        end(running, call, std::move(reload), std::move(ticket), done);
      });
}

/// [control] Ends a dry run: the answer shows the prepared reload, and [factory] frees it.
void answer_dry_reload(Running& running, const CallPtr& call, ReloadPtr reload, Ticket ticket) {
  Receipt nothing;
  nothing.generation = running.deployer.generation();
  auto result = to_json(reload->prepared ? running.deployer.foresee(**reload->prepared) : nothing);
  result["dry_run"] = true;
  result["plugin"] = reload->name;
  say_sync(reload->prepared, result);
  say_who_stands(running, reload->change, Asked::dry_run, result);
  say_lines(reload->lines, result);
  say_same_build(reload->lines, result);
  say_notes(reload->notes, result);
  answer(running, *call, std::move(result));
  running.control.in_factory(
      [reload = std::move(reload)]() mutable {
        reload->prepared.reset();
        reload->change = {};
        reload->loaded.reset();
        reload.reset();
      },
      [ticket = std::move(ticket)] {});
}

/// [control]
void put_reload_in_force(Running& running, const CallPtr& call, ReloadPtr reload, Ticket ticket) {
  const FromLookToAct still(running);
  if (auto good = may_go_on(running, *call, *reload); !good) {
    return end(running, call, std::move(reload), std::move(ticket), good);
  }
  if (flag(call->params, "dry_run")) {
    return answer_dry_reload(running, call, std::move(reload), std::move(ticket));
  }
  if (reload->change.edits.empty()) {
    const auto done = put_in_books(running, call, *reload);
    return end(running, call, std::move(reload), std::move(ticket), done);
  }
  std::vector<FailureMark> changed;
  for (const auto& edit : reload->change.edits) {
    changed.push_back(mark_failure(running, edit.member));
  }
  auto ongoing = running.deployer.begin(**reload->prepared);
  if (reload->change.probation) {
    expect_lines(running, ongoing, reload->lines);
  }
  when_answered(running, call, std::move(ongoing),
                [&running, call, reload, changed = std::move(changed),
                 ticket = std::move(ticket)](Ongoing& swapped) mutable {
                  const auto receipt = swapped.result();
                  reload->retired = std::move(swapped.retired());
                  if (reload->change.probation) {
                    remember_lines(running, call->made, reload->lines);
                  }
                  Status done = ok();
                  if (receipt) {
                    reload->receipt = *receipt;
                    if (reload->change.probation) {
                      call->mark = Confirmation::unconfirmed;
                    } else {
                      begin_unproven(running, *call, std::move(changed));
                    }
                    done = put_in_books(running, call, *reload);
                  } else {
                    done = receipt.error();
                  }
                  if (reload->change.probation && done) {
                    return end(running, call, std::move(reload), std::move(ticket), done);
                  }
                  end_when_settled(running, call, std::move(reload), std::move(ticket), done);
                });
}

/// [control] The elements of now, made by the new file, did no harm elsewhere.
void reload_in_factory(Running& running, const CallPtr& call, ReloadPtr reload, Ticket ticket) {
  running.control.in_factory([&running, reload] { prepare(running, *reload); },
                             [&running, call, reload, ticket = std::move(ticket)]() mutable {
                               put_reload_in_force(running, call, std::move(reload),
                                                   std::move(ticket));
                             },
                             [&running, call, name = reload->name](const std::string& hook) {
                               answer(running, *call, thread_abandoned(running, hook, name));
                             });
}

}  // namespace

void reload_plugin(Running& running, const CallPtr& call, Ticket ticket) {
  auto reload = std::make_shared<Reload>();
  reload->name = text_or(call->params, "plugin");
  if (running.catalog.find(reload->name) == nullptr) {
    return answer(running, *call,
                  refuse({Errc::unknown_name, "plugin_not_loaded"}, reload->name,
                         "no such plugin is loaded", "mauvectl load " + reload->name));
  }
  const auto policy = state_policy(call->params);
  if (!policy) {
    return answer(running, *call, policy.error());
  }
  const auto probation = probation_of(call->params);
  if (!probation) {
    return answer(running, *call, probation.error());
  }
  if (auto allowed = check_former(running, reload->name); !allowed) {
    return answer(running, *call, allowed.error());
  }
  Question question{arch::to_json_text(described(running))};
  question.loads = true;
  try_out(
      running, call, question, reload->name,
      [&running, call, reload, policy = *policy, probation = *probation,
       ticket = std::move(ticket)] {
        reload->change = members_of(running, reload->name, policy);
        reload->change.made_from = running.deployer.generation(/*before_stops=*/true);
        if (flag(call->params, "in_place")) {
          return reload_in_place(running, call, ticket, reload->name, std::move(reload->change));
        }
        auto allowed = check_abandoned_in(running, reload->change);
        if (!reload->change.edits.empty()) {
          reload->change.probation = probation;
        } else if (allowed) {
          allowed = ask_for_no_probation(call->params,
                                         "nothing that runs comes from " + reload->name +
                                             ", so there is nothing to try out or to take back",
                                         "put the former file in place and reload it to go back");
        }
        if (!allowed) {
          return answer(running, *call, allowed.error());
        }
        reload_in_factory(running, call, reload, ticket);
      });
}

}  // namespace mauve::daemon
