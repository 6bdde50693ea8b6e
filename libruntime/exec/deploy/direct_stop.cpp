// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/deploy/direct_stop.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include <mauve/host/ongoing.h>

#include "base/mutex.h"

namespace mauve::exec {
namespace {

/// The time for the jobs under way to end. It is the time that a task allows, and the time that the
/// guard needs to judge and to end a job that goes on.
constexpr Duration kParkingMayTake = Task::kHaltedJob + 500ms;
/// For those that read the safe values; a slower one is not waited for.
constexpr Duration kActingMayTake = 500ms;
constexpr Duration kActsSoon = 100ms;

bool is_one_of(const std::vector<std::string>& names, const Deployed& deployed) {
  return names.empty() ||
         std::find(names.begin(), names.end(), deployed.task->name()) != names.end();
}

/// Keeps names, not tasks: a component that leaves meanwhile is freed as ever, and has parked.
class Halt final : public DirectStop {
 public:
  Halt(System& system, std::vector<std::string> names)
      : system_(system), names_(std::move(names)), first_only_(names_.empty()) {
    const MutexLock lock(system_.members);
    for (const Deployed& deployed : system_.deployed) {
      const bool runs = deployed.state() == ComponentState::running;
      if (runs && is_one_of(names_, deployed)) ran_.push_back(deployed.task->name());
    }
    order();
  }

  bool advance() override {
    const MutexLock lock(system_.members);
    if (over_) return true;
    look();
    const bool late = now() >= until_;
    if (!run_still_.empty() && !late) return false;
    if (!first_only_) return over_ = true;
    if (acting_.empty() && until_acted_ == 0) begin_acting();
    if (!acted() && now() < until_acted_) return false;
    first_only_ = false;
    order();
    return false;
  }

  [[nodiscard]] const std::vector<std::string>& ran() const override { return ran_; }
  [[nodiscard]] const std::vector<std::string>& run_still() const override { return run_still_; }

 private:
  [[nodiscard]] Instant now() const { return system_.runner->now(); }
  [[nodiscard]] bool is_ordered(const Deployed& deployed) const {
    return is_one_of(names_, deployed) &&
           (!first_only_ || deployed.task->watch().has_safe_values() ||
            deployed.task->outputs().holds_any());
  }

  /// Also those that are parked: a start may be under way.
  void order() {
    until_ = now() + kParkingMayTake.count();
    for (Deployed& deployed : system_.deployed) {
      if (!is_ordered(deployed)) continue;
      deployed.task->mailbox().halt();
      system_.runner->wake(*deployed.task);
    }
    system_.runner->look_again();
    look();
  }

  void look() {
    run_still_.clear();
    for (const Deployed& deployed : system_.deployed) {
      const bool waited_for = is_ordered(deployed) && deployed.state() == ComponentState::running;
      if (waited_for) run_still_.push_back(deployed.task->name());
    }
  }

  /// A job that is under way may have read before; the one after it has not.
  void begin_acting() {
    until_acted_ = now() + kActingMayTake.count();
    const Instant soon = now() - system_.t0 + kActsSoon.count();
    for (const Deployed& deployed : system_.deployed) {
      const Counters& counters = deployed.task->counters();
      const bool acts = deployed.state() == ComponentState::running && !is_ordered(deployed) &&
                        counters.next_release.load() < soon;
      if (acts) acting_.emplace_back(deployed.task->name(), counters.releases.load());
    }
  }
  [[nodiscard]] bool acted() const {
    return std::all_of(acting_.begin(), acting_.end(), [this](const auto& one) {
      return std::none_of(system_.deployed.begin(), system_.deployed.end(), [&](const Deployed& d) {
        return d.task->name() == one.first && d.state() == ComponentState::running &&
               d.task->counters().releases.load() <= one.second + 1;
      });
    });
  }

  System& system_;
  const std::vector<std::string> names_;  // empty: all
  bool first_only_;                       // of all, those that write safe values
  bool over_ = false;
  Instant until_ = 0;
  Instant until_acted_ = 0;
  std::vector<std::pair<std::string, std::uint64_t>> acting_;  // and their releases before
  std::vector<std::string> ran_;
  std::vector<std::string> run_still_;
};

}  // namespace

std::unique_ptr<DirectStop> begin_direct_stop(System& system, std::vector<std::string> components) {
  {
    const MutexLock lock(system.members);
    const bool known = std::all_of(components.begin(), components.end(), [&](const auto& name) {
      return std::any_of(system.deployed.begin(), system.deployed.end(),
                         [&](const Deployed& one) { return one.task->name() == name; });
    });
    if (!known) return nullptr;
  }
  return std::make_unique<Halt>(system, std::move(components));
}

void end_direct_stop(System& system, const std::vector<std::string>& components) {
  MAUVE_ON_THREAD(control);
  for (Deployed& deployed : system.deployed) {
    if (is_one_of(components, deployed)) deployed.task->mailbox().end_halt();
  }
}

}  // namespace mauve::exec
