// SPDX-License-Identifier: LGPL-3.0-or-later
#include "daemon.h"

#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <iostream>
#include <random>

#include "arch/build/load.h"
#include "changes/urgent_share.h"
#include "commands/audit.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/quarantine.h"
#include "commands/recovery/unproven.h"
#include "commands/stops.h"
#include "mauve/host/architecture.h"
#include "mauve/host/version.h"
#include "monitor/runtime_events.h"
#include "monitor/service_status.h"
#include "notify.h"
#include "rt/thread/crash_handler.h"
#include "start_warnings.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using std::chrono::milliseconds;

constexpr Duration kComponentsMayTake = 2s;
/// So much longer when their threads are not real-time: a loaded machine keeps such a thread
/// waiting.
constexpr Duration kOrdinaryMayTake = 4s;
constexpr milliseconds kLastAnswers{500};
/// All of the above, the change under way (its commit is bounded too), and some air: less than
/// TimeoutStopSec= in the unit.
constexpr milliseconds kWholeEndMayTake{12'000};
constexpr milliseconds kCrashHandlerMayTake{150};
/// Exit code when code of a plugin called exit(0): a service manager starts mauved again.
constexpr int kUnexpectedEnd = 70;

std::string random_id() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 16; ++i) {
    id += "0123456789abcdef"[random() % 16];
  }
  return id;
}

}  // namespace

Daemon::Daemon(Options options)
    : options_(std::move(options)),
      deciding_(deciding_paths(options_)),
      log_(options_.log_level),
      catalog_(options_.plugin_dirs) {}

Daemon::~Daemon() = default;

int Daemon::run() {
  if (auto opened = open_log(); !opened) {
    notify::status("refused: " + to_string(opened.error()));
    std::cerr << "error: " << to_string(opened.error()) << "\n";
    return 1;
  }
  log_.write(Event::daemon_starting,
             {{"version", std::string(kVersion)}, {"file", options_.architecture}});
  reaper_.emplace(signals_, [this](const std::string& why) { leave_by_force(why); });
  const auto started = start();
  const auto signal = reaper_->start_is_over();
  if (!started) {
    report_refusal(started.error());
    if (store_) {
      store_->last_run().refused();
    }
    return 1;
  }
  try {
    if (auto serving = serve(); !serving) {
      report_refusal(serving.error());
      return shut_down("a socket that cannot be served");
    }
  } catch (const std::exception& failed) {
    leave_without(failed.what());
  }
  const auto in_io = [this](auto job) { server_->post(std::move(job)); };
  return shut_down(signal ? *signal : serve_until_signal(*running_, signals_, in_io));
}

Status Daemon::open_log() {
  log_.add_sink(logging::stderr_is_journal() ? logging::journal_sink() : logging::terminal_sink());
  if (!options_.log_file.empty()) {
    auto file = logging::file_sink(options_.log_file);
    if (!file) {
      return file.error();
    }
    log_.add_sink(*std::move(file));
  }
  log_.start();
  return ok();
}

/// The socket first: two daemons must not hold the same hardware, not even for a moment.
Status Daemon::start() {
  if (auto trusted = check_trust(deciding_, options_.realtime, log_); !trusted) {
    return trusted;
  }
  auto endpoint = server::Endpoint::open(options_.socket);
  if (!endpoint) {
    return endpoint.error();
  }
  endpoint_.emplace(std::move(*endpoint));
  if (auto opened = open_store(); !opened) {
    return opened;
  }
  if (auto begun = guardian_.start(options_); !begun) {
    return begun;
  }
  if (auto loaded = load(); !loaded) {
    return loaded;
  }
  return deploy();
}

Status Daemon::open_store() {
  if (options_.state_dir.empty()) {
    return ok();
  }
  auto store = StateStore::open(options_.state_dir, log_);
  if (!store) {
    return store.error();
  }
  store_ = std::move(*store);
  return ok();
}

Status Daemon::load() {
  auto origin = what_to_start(options_, store_.get(), log_);
  if (!origin) {
    return origin.error();
  }
  origin_ = *std::move(origin);
  if (store_) {
    store_->last_run().try_generation(origin_.generation);
  }
  if (auto entered = enter_folder(); !entered) {
    return entered;
  }
  arch::Problems problems;
  rules::Supervision supervision;
  const auto lost = origin_.generation != 0 ? arch::LostNames::kept : arch::LostNames::refused;
  architecture_ = arch::load(origin_.text, catalog_, problems, &supervision, lost);
  for (const auto& problem : problems.sorted()) {
    log_.write(Event::start_refused, {{"text", arch::to_string(problem, origin_.file)},
                                      {"line", static_cast<std::int64_t>(problem.where.line)},
                                      {"at", problem.error.at}});
  }
  if (architecture_ == nullptr) {
    return refuse({Errc::invalid_value, "file_has_errors"}, origin_.file,
                  arch::summary(problems.sorted()), notify::how_to_see_all());
  }
  keep_stopped();
  supervisor_.adopt(std::move(supervision));
  for (const auto* loaded : catalog_.plugins()) {
    log_loaded(log_, loaded->info());
  }
  return ok();
}

/// A stop outlives the run, also if the generation that is started is older than the stop.
void Daemon::keep_stopped() {
  user_stops_ = origin_.stops;
  for (const auto& name : origin_.stopped) {
    if (auto* component = architecture_->find_component(name)) {
      component->task().start = false;
      log_.write(Event::stays_stopped,
                 {{"component", name},
                  {"text", "generation " + std::to_string(origin_.stopped_in) +
                               ", the last one before this start, has it stopped"}});
    }
  }
  for (const auto& name : leave_stopped(user_stops_, *architecture_)) {
    log_.write(Event::stays_stopped,
               {{"component", name}, {"text", in_words(*user_stops_.of(name))}});
  }
}

/// So that a path in the architecture begins at the architecture, wherever mauved was started.
Status Daemon::enter_folder() {
  std::error_code failed;
  std::filesystem::current_path(origin_.folder, failed);
  if (failed) {
    return refuse({Errc::system, "folder_not_entered"}, origin_.folder,
                  "cannot be entered: " + failed.message(),
                  "paths in the architecture begin there");
  }
  return ok();
}

Status Daemon::deploy() {
  DeployOptions how{options_.realtime, false, options_.admission, options_.machine};
  // Their numbers go on from those of earlier runs.
  how.stops = &user_stops_;
  how.first_generation = store_ ? store_->generations().newest() + 1 : 1;
  deployer_ = std::make_unique<Deployer>(*architecture_, how);
  if (store_) {
    log_cores_in_quarantine(log_, *architecture_, cores_in(store_->quarantined(), catalog_));
  }
  if (auto deployed = deployer_->deploy(); !deployed) {
    return deployed;
  }
  log_.set_source(runtime_events_of(*deployer_, supervisor_));
  if (options_.realtime == Realtime::off) {
    log_.write(Event::realtime_off);
  }
  log_start_warnings(log_, *deployer_, *architecture_, catalog_, supervisor_.supervision());
  return ok();
}

Status Daemon::serve() {
  running_.reset(new Running{*architecture_, *deployer_, catalog_, control_, log_, watches_,
                             supervisor_, [this] { return server_->clients(); }, random_id(),
                             std::chrono::steady_clock::now()});
  running_->realtime = options_.realtime;
  running_->user_stops = &user_stops_;
  running_->deciding = deciding_;
  running_->path_dirs = options_.path_dirs;
  rt::EndHandlers::set_unexpected_status(kUnexpectedEnd);
  running_->recorder = &recorder_;
  running_->stopper = &stopper_;
  running_->judge = [this](const Asker& asker, const Question& question, const Judge::Then& then) {
    judge_.ask(asker, question, then);
  };
  running_->judge_change = [this](const Question& question, const Judge::Then& then) {
    trials_.ask({}, question, then);
  };
  running_->guardian = &guardian_;
  keep_the_first();
  table_ = std::make_unique<CommandTable>(*running_);
  server::ServerOptions how{{}, server::machine_rules(), server::machine_rules};
  how.after_work = urgent_within_share(options_.urgency());
  server_ = std::make_unique<server::Server>(std::move(how), *table_, log_);
  recorder_.start(*running_);
  const auto state = state_line(*running_);
  supervisor_.start(*running_);
  stopper_.start(*deployer_, options_.urgency_of_watch(),
                 [this](bool now) { control_.set_priority(now ? options_.urgency() : 0); });
  control_.start();
  guardian_.serve(*running_);
  judge_.start(judge_command(options_), options_.prepare_within);
  trials_.start(judge_command(options_), options_.prepare_within);
  watches_.start(*running_);
  health_monitor_.start(*running_);
  if (auto opened = server_->open(std::move(*endpoint_)); !opened) {
    return opened;
  }
  endpoint_.reset();
  server_->start();
  log_.write(Event::daemon_running, {{"text", state}});
  notify::ready(state);
  return ok();
}

/// Before the first client.
void Daemon::keep_the_first() {
  running_->generation = deployer_->generation();
  if (!store_) {
    return;
  }
  running_->store = store_.get();
  restore_quarantine(*running_);
  if (const auto saved = store_->generations().find(origin_.generation)) {
    running_->other_builds = other_builds(saved->builds, catalog_);
    log_other_builds(log_, saved->number, running_->other_builds);
  }
  Generation first;
  first.number = running_->generation;
  first.boot = running_->boot;
  first.time = logging::utc(std::chrono::system_clock::now());
  first.uid = geteuid();
  first.command = origin_.generation == 0 ? kStart : kRecover;
  first.mark = Confirmation::unconfirmed;
  first.crashes = origin_.crashes;
  first.builds = builds_of(catalog_);
  first.reason =
      origin_.generation == 0 ? origin_.file : "generation " + std::to_string(origin_.generation);
  store_->stops().keep(user_stops_);
  store_->begin(first, described(*running_), origin_.generation);
  begin_start(*running_, origin_.replaces, origin_.crashes);
  running_->recovered = origin_.generation;
}

int Daemon::shut_down(const std::string& cause) {
  reaper_->end_begins(kWholeEndMayTake);
  log_.write(Event::daemon_stopping, {{"cause", cause}});
  const auto abandoned = stop_components();  // before all that may wait for others
  notify::stopping("stopping on " + cause);
  health_monitor_.stop();
  stopper_.stop();
  for (const auto& name : abandoned) {
    log_.write(Event::component_stuck, {{"component", name}});
  }
  all_stopped_ = abandoned.empty();
  if (all_stopped_) {
    guardian_.stop(true);  // else it sends its orders when this process is gone
  }
  recorder_.stop();
  judge_.stop();
  trials_.stop();
  server_->stop(kLastAnswers);
  supervisor_.stop();
  control_.stop();
  watches_.stop();
  report_counted_refusals(*running_, std::chrono::steady_clock::time_point::max());
  if (store_) {
    store_->end();
  }
  log_.flush();
  log_.set_source({});
  const auto hooks = control_.abandoned_threads();
  for (const auto& left : hooks) {
    log_.write(Event::hook_abandoned, {{"hook", left.hook}});
  }
  const bool tidy = abandoned.empty() && hooks.empty();
  if (!tidy) {
    log_.write(Event::threads_left, {{"text", listed(abandoned, hooks)}});
  }
  log_.write(Event::daemon_stopped);
  log_.stop();
  if (!tidy) {
    // A thread still runs in code that a tidy end would unmap under its feet.
    _exit(1);
  }
  reaper_->end_is_over();
  return 0;
}

/// The stop runs on [control] before all requests that wait there, so no change is under way
/// meanwhile, and none can follow. If [control] does not reach this stop, [stop] stops the
/// components at once, and the reaper ends the process.
std::vector<std::string> Daemon::stop_components() {
  std::promise<std::vector<std::string>> stopped;
  const auto order = std::make_shared<StopOrder>(std::vector<std::string>(), nullptr, nullptr);
  stopper_.watch(order);
  control_.urgent([&] {
    order->begin();
    auto abandoned = deployer_->shutdown(kComponentsMayTake, kOrdinaryMayTake);
    for (const auto& name : order->stopped_directly()) {
      running_->stopped_by_end.insert(name);
    }
    stopped.set_value(std::move(abandoned));
    control_.halt();
  });
  return stopped.get_future().get();
}

/// The process ends right afterwards. The safe values come first: [control], the log or the disk
/// may hang, and no end that mauved itself decides leaves an output as it was.
void Daemon::leave_by_force(const std::string& cause) {
  if (store_) {
    store_->last_run().ends_by_order();
  }
  const bool safe = rt::run_crash_handler({.sent = true});
  log_.write(Event::daemon_hurried,
             {{"cause", cause},
              {"text", all_stopped_ ? "after all components stopped with their safe values written"
                       : safe       ? "after the safe values were written"
                                    : "and no safe values could be written now"}});
  std::this_thread::sleep_for(kCrashHandlerMayTake);
  remove_sockets();  // last: [io] would make them anew
}

/// The machine lacked descriptors, threads or memory for the threads that serve. An orderly end
/// could wait for one of those that are missing.
void Daemon::leave_without(const std::string& lacking) {
  report_refusal(refuse({Errc::system, "socket_failed"}, options_.socket,
                        "cannot be served: " + lacking,
                        "raise the limits of the process (LimitNOFILE=, TasksMax=, MemoryMax=)"));
  leave_by_force("no command can be served");
  if (store_) {
    store_->last_run().refused();
  }
  log_.flush();
  _exit(1);
}

void Daemon::report_refusal(const Error& error) {
  log_.write(Event::start_refused, {{"text", to_string(error)}, {"at", error.at}});
  notify::status("refused: " + to_string(error));
  log_.flush();
}

}  // namespace mauve::daemon
