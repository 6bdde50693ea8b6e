// SPDX-License-Identifier: LGPL-3.0-or-later
/// The life of mauved: load, check, build, deploy, serve, shut down.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "changes/stopper.h"
#include "commands/command.h"
#include "commands/table.h"
#include "judge/judge.h"
#include "monitor/guardian.h"
#include "monitor/health_monitor.h"
#include "monitor/watch.h"
#include "options.h"
#include "server/server.h"
#include "signals.h"
#include "state/deciding_paths.h"
#include "state/recovery.h"
#include "state/state_store.h"
#include "supervision/supervisor.h"
#include "trace/recorder.h"

namespace mauve::daemon {

/// `mauved --check`: prints everything wrong with the file, one line each. 0: nothing. [main]
[[nodiscard]] int check_file(const Options& options);

class Daemon {
 public:
  explicit Daemon(Options options);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Runs until a signal ends it. The exit code: 0 after an orderly end, 1 when it could not start,
  /// or when a core hung and its thread had to be abandoned. [main], before any other thread.
  [[nodiscard]] int run();

 private:
  Status open_log();
  Status open_store();
  Status start();
  Status load();
  void keep_stopped();
  Status enter_folder();
  Status deploy();
  Status serve();
  void keep_the_first();
  [[nodiscard]] int shut_down(const std::string& cause);
  [[nodiscard]] std::vector<std::string> stop_components();
  void leave_by_force(const std::string& cause);
  void remove_sockets() const {
    if (endpoint_) {
      endpoint_->remove_names();
    } else if (server_ != nullptr) {
      server_->remove_names();
    }
  }
  [[noreturn]] void leave_without(const std::string& lacking);
  void report_refusal(const Error& error);

  const Options options_;
  const std::vector<DecidingPath> deciding_;
  std::atomic<bool> all_stopped_{false};  ///< at the end, with their safe values written
  Signals signals_{!options_.log_file.empty()};
  logging::Log log_;
  Guardian guardian_{log_};
  std::optional<server::Endpoint> endpoint_;
  std::unique_ptr<StateStore> store_;  ///< null: nothing is kept
  Origin origin_;
  plugin::Catalog catalog_;
  UserStops user_stops_;
  std::unique_ptr<Architecture> architecture_;
  std::unique_ptr<Deployer> deployer_;
  Stopper stopper_{log_};
  Control control_{options_.prepare_within};
  Watches watches_{log_};
  Supervisor supervisor_{control_};
  HealthMonitor health_monitor_;
  Recorder recorder_{options_.flight_recorder};
  Judge judge_{control_};
  Judge trials_{control_};  ///< of changes, which wait for no client's file
  std::unique_ptr<Running> running_;
  std::unique_ptr<CommandTable> table_;
  std::unique_ptr<server::Server> server_;
  std::optional<Reaper> reaper_;  ///< from the start to the end; uses all above
};

}  // namespace mauve::daemon
