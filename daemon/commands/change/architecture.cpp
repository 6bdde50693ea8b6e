// SPDX-License-Identifier: LGPL-3.0-or-later
/// architecture.apply and architecture.diff. The latter is judged in a process of its own; the
/// former:
///
///   [trial]   make everything in a process of its own, in case that it crashes or hangs.
///   [factory] parse, load plugins beside the running ones, make all elements.
///   [control] compare the wanted system with the running one.
///   [factory] prepare the new elements.
///   [control] put the change in force; names of new plugins come into the catalog.
///   [factory] free the elements that are not needed.
#include "commands/change/architecture.h"

#include "base/thread_role.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "arch/build/check_rules.h"
#include "arch/build/load.h"
#include "arch/compare/diff_rules.h"
#include "arch/text/value_json.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/change/policies.h"
#include "commands/change/trial.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/quarantine.h"
#include "commands/say.h"
#include "commands/stops.h"
#include "mauve/host/architecture.h"
#include "start_warnings.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

using logging::Event;

/// Another architecture beside the running one.
class Application final : public ChangeHooks {
 public:
  Application(Running& running, std::string text, std::optional<Generation> saved, bool dry_run)
      : running_(running),
        text_(std::move(text)),
        saved_(std::move(saved)),
        catalog_(running.catalog),
        dry_run_(dry_run) {}
  /// The texts that the elements logged last lie in the code of their plugin, so the elements go
  /// first.
  ~Application() override {
    wanted_.reset();
    difference_ = {};
    if (!plugins_.empty()) {
      running_.log.flush();
    }
  }

  /// [factory]
  void load() {
    const auto lost = saved_ ? arch::LostNames::kept : arch::LostNames::refused;
    wanted_ = arch::load(text_, catalog_, problems_, &supervision_, lost);
    if (problems_.empty()) {
      for (const auto& note : arch::notes_on(supervision_, *wanted_, catalog_)) {
        notes_on_rules_.push_back(to_string(note));
      }
    }
  }
  [[nodiscard]] const arch::Problems& problems() const { return problems_; }
  [[nodiscard]] const std::optional<Generation>& saved() const { return saved_; }

  /// [control] Once the file turned out to be good.
  void compare() {
    MAUVE_ON_THREAD(control);
    const UserStops none;
    const auto& stops = running_.user_stops == nullptr ? none : *running_.user_stops;
    for (const auto& name : leave_stopped(stops, *wanted_)) {
      stay_stopped_.push_back(note_on(name, *stops.of(name)));
    }
    difference_ = arch::compare(running_.architecture, *wanted_, parked_now(running_));
    elements_ = !difference_.lines.empty();
    compare_supervision();
    for (const auto* loaded : catalog_.plugins()) {
      if (running_.catalog.find(loaded->info().name) == nullptr) {
        plugins_.push_back(loaded->info().name);
      }
    }
  }
  [[nodiscard]] bool same() const { return difference_.lines.empty() && plugins_.empty(); }
  [[nodiscard]] bool changes_elements() const { return elements_; }
  [[nodiscard]] bool only_loads() const { return !elements_ && !supervises_; }
  /// Its name is part of a file, but no part that can change.
  [[nodiscard]] Status named_alike() const {
    if (wanted_->name() == running_.architecture.name()) {
      return ok();
    }
    return refuse({Errc::unsupported, "other_architecture"}, "name",
                  "the file is of architecture \"" + wanted_->name() + "\", \"" +
                      running_.architecture.name() + "\" is running",
                  "keep the name, or start mauved with this file");
  }
  /// Also of cores whose plugin only the file loads.
  [[nodiscard]] Status check_cores() const {
    return check_quarantine(running_, difference_.change,
                            [this](const std::string& core) { return build_of(catalog_, core); });
  }
  /// A change of a contract goes by the barrier, unless it was asked for something else.
  [[nodiscard]] Change take_change(StatePolicy state, std::optional<Sync> asked) {
    for (auto& edit : difference_.change.edits) {
      edit.state = state;
    }
    for (auto& joining : difference_.change.new_resources) {
      joining.state = state;
    }
    difference_.change.sync =
        asked.value_or(difference_.exchanged.empty() ? Sync::cut : Sync::barrier);
    difference_.change.changes_rules = supervises_;
    difference_.change.made_from = running_.deployer.generation(/*before_stops=*/true);
    return std::move(difference_.change);
  }

  Status check_prepared(PreparedChange& /*change*/) override { return check_loaded(); }
  /// The rules are still those that the file was compared with, and its plugins fit.
  [[nodiscard]] Status check_loaded() const {
    if (running_.supervisor.adoptions() != compared_with_) {
      return refuse({Errc::conflict, "changed_meanwhile"}, "rules",
                    "were changed by a rollback after the file was compared with them",
                    "look at what runs now, then apply the file again");
    }
    for (const auto& name : plugins_) {
      if (auto good = running_.catalog.check_types(*catalog_.find(name)); !good) {
        return good;
      }
    }
    return ok();
  }
  void in_force(std::uint64_t generation) override {
    if (supervises_) {
      running_.supervisor.adopt(std::move(supervision_), generation);
    }
    for (const auto& name : plugins_) {
      const auto& loaded = *catalog_.find(name);
      // It was checked, and no other change came in between.
      static_cast<void>(running_.catalog.commit(loaded));
      log_loaded(running_.log, loaded.info());
    }
  }
  void complete(Json& result) override {
    result["lines"] = Json::array();
    for (const auto& line : all_lines()) {
      result["lines"].push_back(to_json(line));
    }
    if (!difference_.exchanged.empty()) {
      result["exchanged"] = difference_.exchanged;
    }
    if (dry_run_) {
      result["dry_run"] = true;
    }
    auto notes = saved_ ? notes_on(saved_->number, other_builds(saved_->builds, catalog_))
                        : std::vector<std::string>();
    notes.insert(notes.end(), notes_on_rules_.begin(), notes_on_rules_.end());
    notes.insert(notes.end(), stay_stopped_.begin(), stay_stopped_.end());
    const auto source = saved_ ? "generation " + std::to_string(saved_->number) : "the file";
    std::ranges::move(notes_on_starts(difference_.lines, source, dry_run_),
                      std::back_inserter(notes));
    say_notes(notes, result);
  }
  [[nodiscard]] std::optional<std::vector<arch::Line>> lines() const override {
    return all_lines();
  }
  [[nodiscard]] bool dry_run() const override { return dry_run_; }

 private:
  [[nodiscard]] std::vector<arch::Line> all_lines() const {
    std::vector<arch::Line> lines;
    for (const auto& name : plugins_) {
      lines.push_back(arch::make_line("plugin", name, {}, name));
    }
    std::ranges::copy(difference_.lines, std::back_inserter(lines));
    return lines;
  }
  void compare_supervision() {
    compared_with_ = running_.supervisor.adoptions();
    auto lines = arch::compare(running_.supervisor.supervision(), supervision_);
    supervises_ = !lines.empty();
    std::ranges::move(running_.supervisor.notes_on_change(supervision_),
                      std::back_inserter(notes_on_rules_));
    if (!supervises_) {
      notes_on_rules_.clear();
    }
    std::ranges::move(lines, std::back_inserter(difference_.lines));
  }

  Running& running_;
  std::string text_;
  std::optional<Generation> saved_;  // of which the text is
  plugin::Catalog catalog_;          // the running one, with the additions of the file
  bool dry_run_;
  arch::Problems problems_;
  std::unique_ptr<Architecture> wanted_;
  arch::Difference difference_;
  bool elements_ = false;
  rules::Supervision supervision_;
  std::vector<std::string> notes_on_rules_;
  std::vector<std::string> stay_stopped_;  // components that the file would start
  std::uint64_t compared_with_ = 0;        // see Supervisor::adoptions()
  bool supervises_ = false;                // its rules, transactions or permissions are others
  std::vector<std::string> plugins_;       // not loaded yet
};
using ApplicationPtr = std::shared_ptr<Application>;

/// [control] Nothing of the application is touched on this thread afterwards.
void free_in_factory(Running& running, ApplicationPtr application, Ticket ticket) {
  MAUVE_ON_THREAD(control);
  running.control.in_factory(
      [application = std::move(application)]() mutable { application.reset(); },
      [ticket = std::move(ticket)] {});
}

/// A saved generation is as it was: the plugins of now are others.
void refuse_saved(Running& running, const Call& call, const Generation& saved, Json errors) {
  const auto number = std::to_string(saved.number);
  std::string hint;
  for (const auto& one : other_builds(saved.builds, running.catalog)) {
    hint += "it ran build " + short_build(one.recorded) + " of " + one.plugin + ", and build " +
            short_build(one.runs) + " runs: " + remedy_of(one) + "; ";
  }
  refuse_text(running, call,
              "generation " + number + " cannot run with the plugins of now: its file has",
              hint + "mauvectl history lists the others", std::move(errors));
}

void refuse_file(Running& running, const Call& call, Json errors) {
  const bool lacks_plugin = std::any_of(errors.begin(), errors.end(), [](const Json& one) {
    return text_or(one, "id") == "plugin_not_found";
  });
  refuse_text(running, call, "the file has",
              std::string("correct the file") +
                  (lacks_plugin ? ", or start mauved with --plugin-dir of that plugin" : "") +
                  "; mauvectl check looks at it again",
              std::move(errors));
}

void answer_unchanged(Running& running, const Call& call, Application& application) {
  Receipt receipt;
  receipt.generation = running.generation;
  auto result = to_json(receipt);
  application.complete(result);
  answer(running, call, std::move(result));
}

/// [control] Plugins are all that the file adds: no component takes part, no new generation.
void load_only(Running& running, const Call& call, Application& application) {
  MAUVE_ON_THREAD(control);
  auto good = ask_for_no_probation(call.params,
                                   "the file adds plugins and changes nothing that runs, so there "
                                   "is nothing to try out or to take back",
                                   "mauvectl unload takes a plugin away");
  good = good ? check_conditions(running, call) : good;
  good = good ? application.check_loaded() : good;
  good = good ? may_change(running, call, *application.lines()) : good;
  if (!good) {
    return answer(running, call, good.error());
  }
  application.in_force(running.generation);
  Receipt receipt;
  receipt.generation = running.generation;
  receipt.state = ChangeState::applied;
  auto result = to_json(receipt);
  application.complete(result);
  answer(running, call, std::move(result));
}

/// [control] The file is good, and compared.
void apply_judged(Running& running, const CallPtr& call, ApplicationPtr application,
                  Ticket ticket) {
  MAUVE_ON_THREAD(control);
  const auto state = state_policy(call->params);
  const auto sync = sync_of(call->params);
  auto fits = application->named_alike();
  if (fits) {
    fits = application->check_cores();
  }
  if (!state || !sync || !fits) {
    answer(running, *call, !state ? state.error() : !sync ? sync.error() : fits.error());
  } else if (application->same() || (application->dry_run() && !application->changes_elements())) {
    answer_unchanged(running, *call, *application);
  } else if (application->only_loads()) {
    load_only(running, *call, *application);
  } else {
    auto change = application->take_change(*state, *sync);
    return apply(running, call, std::move(ticket), std::move(change), std::move(application));
  }
  free_in_factory(running, std::move(application), std::move(ticket));
}

/// [factory] makes its elements, then it is compared.
void load_then_apply(Running& running, const CallPtr& call, ApplicationPtr application,
                     Ticket ticket) {
  auto work = [application] { application->load(); };
  auto then = [&running, call, application = std::move(application),
               ticket = std::move(ticket)]() mutable {
    if (!application->problems().empty()) {
      auto errors = to_json(application->problems());
      const auto& saved = application->saved();
      saved ? refuse_saved(running, *call, *saved, std::move(errors))
            : refuse_file(running, *call, std::move(errors));
      return free_in_factory(running, std::move(application), std::move(ticket));
    }
    const FromLookToAct still(running);
    application->compare();
    apply_judged(running, call, std::move(application), std::move(ticket));
  };
  running.control.in_factory(std::move(work), std::move(then),
                             [&running, call](const std::string& hook) {
                               answer(running, *call, thread_abandoned(running, hook, "file"));
                             });
}

}  // namespace

void apply_architecture(Running& running, const CallPtr& call, Ticket ticket, std::string text,
                        const std::optional<Generation>& saved) {
  MAUVE_ON_THREAD(control);
  if (saved) {
    call->params["file"] = "generation " + std::to_string(saved->number);  // the place of errors
    if (text_or(call->params, "reason").empty()) {
      call->params["reason"] = "rollback to generation " + std::to_string(saved->number);
    }
  }
  auto question = question_of(running, *call);
  question.text = text;
  question.loads = true;
  auto application =
      std::make_shared<Application>(running, std::move(text), saved, flag(call->params, "dry_run"));
  try_out(running, call, question, text_or(call->params, "file", "text"),
          [&running, call, application, ticket = std::move(ticket)] {
            load_then_apply(running, call, application, ticket);
          });
}

void apply_file(Running& running, const CallPtr& call, Ticket ticket) {
  apply_architecture(running, call, std::move(ticket), text_or(call->params, "text"));
}

/// In a process of its own, so that a viewer may ask: nothing that the file names is made here.
void diff_architecture(Running& running, const CallPtr& call, Ticket /*none*/) {
  auto question = question_of(running, *call);
  question.running = arch::to_json_text(described(running));
  question.builds = builds_of(running.catalog);
  const auto compared = running.deployer.generation();  // a later one may run when the answer comes
  running.judge(asker_of(*call), question, [&running, call, compared](Result<Json> judged) {
    if (!judged) {
      return answer(running, *call, judged.error());
    }
    if (!(*judged)["errors"].empty()) {
      return refuse_file(running, *call, (*judged)["errors"]);
    }
    judged->erase("errors");
    (*judged)["generation"] = compared;
    leave_stopped(running, *judged);
    answer(running, *call, std::move(judged));
  });
}

Question question_of(const Running& running, const Call& call) {
  Question question{text_or(call.params, "text")};
  for (const auto* plugin : running.catalog.plugins()) {
    question.loaded.push_back(plugin->info().name);
  }
  question.loads = call.caller.role >= server::Role::admin;
  return question;
}

/// All at once: a look while the architecture is walked through could change it. A component that
/// hangs and stops later counts: no start may run it again.
arch::Parked parked_now(const Running& running) {
  MAUVE_ON_THREAD(control);
  std::set<std::string, std::less<>> parked;
  for (const auto& one : running.deployer.status()) {
    // A change may be answered, and saved, when the end of mauved has stopped all components.
    const bool ended = one.ran_until_end || running.stopped_by_end.contains(one.name);
    if (!ended && (one.state == ComponentState::stopped || one.stopping)) {
      parked.insert(one.name);
    }
  }
  return [parked = std::move(parked)](const ComponentBase& component) {
    return parked.contains(component.name());
  };
}

}  // namespace mauve::daemon
