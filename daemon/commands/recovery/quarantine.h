// SPDX-License-Identifier: LGPL-3.0-or-later
/// Quarantine: a new core that failed and was rolled back is not put in force again, and does not
/// stand by as a fallback core. It leaves quarantine when a user releases it, or when its plugin is
/// another build. The other cores of that change do not enter quarantine. An undone change, and one
/// that was not confirmed, bring no core into quarantine. A component that runs the core already
/// goes on with it. The state directory keeps the list.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "base/mutex.h"
#include "commands/command.h"

namespace mauve::daemon {

/// Takes up the list of the run before. Before the first client.
void restore_quarantine(Running& running);

/// [control] The build of the plugin that a core is of; empty: of none that is loaded.
[[nodiscard]] std::string build_of(const Running& running, const std::string& core);
[[nodiscard]] std::string build_of(const plugin::Catalog& catalog, const std::string& core);

/// [control] False: it is there already.
bool quarantine(Running& running, const std::string& core, const std::string& reason);

/// The build of the plugin that a core of this name is of.
using BuildOf = std::function<std::string(const std::string& core)>;

/// [control] Refuses a change that would put a core in force, or let a fallback core stand by, that
/// is in quarantine. `build`: where the change brings builds that are not loaded yet; null: those
/// that are loaded.
[[nodiscard]] Status check_quarantine(const Running& running, const Change& change,
                                      const BuildOf& build = {});

/// The cores whose loaded build is in quarantine, as the deployer asks for them. [any]
class CoresInQuarantine final : public CoresKeptOut {
 public:
  using Names = std::set<std::string, std::less<>>;
  void replace(Names names);
  [[nodiscard]] bool contains(const std::string& core) const override;

 private:
  mutable Mutex mutex_;
  Names names_ MAUVE_GUARDED_BY(mutex_);
};

/// [control] Whether the loaded build of this core is.
[[nodiscard]] bool is_in_quarantine(const Running& running, const std::string& core);

/// [control] The next step for a component that does not run. A start is none for one whose core is
/// in quarantine: it would fail again, and a fresh core of this build is refused.
[[nodiscard]] std::string step_to_run(const Running& running, const ComponentStatus& component);

/// The cores of `quarantine.list` whose build is the one that is loaded.
[[nodiscard]] CoresInQuarantine::Names cores_kept_out(const Json& list,
                                                      const plugin::Catalog& catalog);

/// [control] No fallback core stands by whose build is in quarantine. Call it whenever the list or
/// the loaded builds may be others.
void keep_out(const Running& running);

/// [control] For `status`: rules and transactions that fail while a core is in quarantine, a row
/// each
/// `{"user","core","reason"}`. `user` is "rule in_the_building", "transaction slow_down" where a
/// component may request it, or "the fallback core of control".
[[nodiscard]] Json lost_to_quarantine(const Running& running);

}  // namespace mauve::daemon
