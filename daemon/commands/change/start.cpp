// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.start: the fsm at its initial state, on the next instant of the grid.
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/change/change_request.h"
#include "commands/look/named.h"
#include "commands/model.h"
#include "commands/recovery/quarantine.h"
#include "commands/say.h"
#include "mauve/host/architecture.h"
#include "mauve/host/user_stops.h"

namespace mauve::daemon {

namespace {

Edit edit_to_start(const Running& running, const std::string& name, bool reset) {
  auto edit = edit_of(name);
  edit.mode = Mode::run;
  if (reset) {
    edit.core = running.architecture.find_component(name)->bundle()->core_type;
    edit.state = StatePolicy::drop;
  }
  return edit;
}

/// The answer names the components that run already, and those that may fail again.
class Already final : public ChangeHooks {
 public:
  /// `started` is called when the others have started.
  Already(std::vector<std::string> names, std::vector<std::string> notes,
          std::function<void()> started)
      : names_(std::move(names)), notes_(std::move(notes)), started_(std::move(started)) {}
  Status check_prepared(PreparedChange& /*change*/) override { return ok(); }
  void in_force(std::uint64_t /*generation*/) override { started_(); }
  void complete(Json& result) override {
    say_already(names_, "running", result);
    say_notes(notes_, result);
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::string> notes_;
  std::function<void()> started_;
};

/// A start of all ends a stop of all, also for components that join later.
std::function<void()> ending_stop_of_all(const Running& running, const Call& call) {
  auto* const stops = flag(call.params, "all") ? running.user_stops : nullptr;
  if (stops == nullptr || flag(call.params, "dry_run")) {
    return [] {};
  }
  return [stops, known = stops->newest()] { stops->start_all(known); };
}

}  // namespace

void start(Running& running, const CallPtr& call, Ticket ticket) {
  const auto names = components_meant(running, *call, "start");
  if (!names) {
    return answer(running, *call, names.error());
  }
  if (!check_being_stopped(running, *names)) {  // the stop was asked for before
    return running.control.await(
        [&running, names] { return check_being_stopped(running, *names).has_value(); },
        [&running, call, ticket = std::move(ticket)]() mutable {
          const FromLookToAct still(running);
          start(running, call, std::move(ticket));
        });
  }
  const bool reset = flag(call->params, "reset");
  const auto started = ending_stop_of_all(running, *call);
  Change change;
  change.ends_stops = true;
  std::vector<std::string> run;
  std::vector<std::string> notes;
  for (const auto& name : *names) {
    const auto now = running.deployer.status(name);
    if (now.state != ComponentState::running) {
      change.edits.push_back(edit_to_start(running, name, reset));
      if (is_in_quarantine(running, now.core)) {
        notes.push_back(name + " may fail again: " + step_to_run(running, now));
      }
    } else if (reset && !flag(call->params, "all")) {
      return answer(running, *call,
                    refuse({Errc::wrong_state, "runs_already"}, name,
                           "runs, and only a component that is stopped starts with a fresh state",
                           "mauvectl stop " + name + " first"));
    } else {
      run.push_back(name);
    }
  }
  if (reset) {  // with the cores of now
    change.made_from = running.deployer.generation(/*before_stops=*/true);
  }
  if (change.edits.empty()) {
    started();
    Receipt nothing;
    nothing.generation = running.deployer.generation();
    auto result = to_json(nothing);
    say_already(run, "running", result);
    return answer(running, *call, std::move(result));
  }
  apply(running, call, std::move(ticket), std::move(change),
        std::make_shared<Already>(std::move(run), std::move(notes), started));
}

}  // namespace mauve::daemon
