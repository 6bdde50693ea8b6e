// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probation: after a commit the old bundles stay ready, and the rollback to them is prepared. So a
/// member that fails rolls all members back at their next release, without [control].
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exec/swap/resource_update.h"
#include "exec/system/prepared.h"
#include "exec/system/system.h"

#include <mauve/host/probation.h>

namespace mauve::exec {

/// The rollback of one member, which its task gets together with the update of the change.
struct MemberRollback {
  Deployed* deployed = nullptr;
  Origin origin;
  TaskUpdate* back = nullptr;  ///< owned by the update of the change, then by the task
  std::shared_ptr<const TaskUpdate::Answer> answer;
  std::uint64_t releases_before = 0;
  std::uint64_t quiescent_after = 0;  ///< the count when it was withdrawn
  std::unique_ptr<TaskUpdate> withdrawn;
  bool in_force = true;            ///< the change is
  std::uint64_t last_release = 0;  ///< the last one that is judged; 0: its time has not passed
};

/// One change on probation, or several that joined each other. [control]
class ProbationPeriod {
 public:
  using Content = PreparedChange::Content;

  /// Begins the probation of a committed change. `content` is that of the change, `replaced` the
  /// elements that it replaced, `joined` the generations of the changes that it joined.
  ProbationPeriod(System& system, std::shared_ptr<Content> content,
                  std::vector<MemberRollback> members, std::shared_ptr<Rollback> rollback,
                  Retired replaced, std::uint64_t number, std::vector<std::uint64_t> joined = {});
  ~ProbationPeriod();

  /// Checks whether it is over and reports the end in System::outcomes; false: nothing of it is
  /// left.
  bool advance();
  /// Ends the probation: the change stays, and no failure rolls it back any more. False: it is
  /// being rolled back already.
  bool pass(const std::string& reason, Outcome::Kind kind = Outcome::Kind::passed);
  /// A newer change is in force, to which the rollback gave way.
  void overtake();
  /// A newer change is in force, which rolls its members back from now on. Elements that neither it
  /// nor the rollback needs are freed with this; those that it replaced belong to `heir`.
  void pass_on_to(Content& heir, const std::vector<MemberRollback>& members);
  /// As long as the caller holds this it does not end, except by a failure or undo().
  [[nodiscard]] std::shared_ptr<const void> hold();
  [[nodiscard]] const PreparedChange::Content& content() const { return *content_; }
  [[nodiscard]] const std::vector<MemberRollback>& members() const { return members_; }
  /// The generations that its changes made, the oldest first.
  [[nodiscard]] const std::vector<std::uint64_t>& generations() const { return generations_; }
  [[nodiscard]] OpenProbation look() const;
  [[nodiscard]] const std::shared_ptr<Rollback>& rollback() const { return rollback_; }
  /// False: it is over, or being rolled back already.
  bool undo(const std::string& reason);
  /// Lets the end go unreported: the change is not in force everywhere, so it never made a
  /// generation.
  void go_quietly() { quiet_ = true; }
  /// Takes go_quietly() back, when the rollback takes too long: the change gets a generation.
  void report_after_all();
  [[nodiscard]] bool leads(const Rollback& back) const {
    return rollback_.get() == &back && !reported();
  }
  [[nodiscard]] bool open() const { return phase_ == Phase::watching && rollback_->open(); }
  [[nodiscard]] bool awaits_confirmation() const;
  /// Its end is in System::outcomes; all that remains is to wait until no thread looks at it.
  [[nodiscard]] bool reported() const {
    return phase_ == Phase::withdrawing || phase_ == Phase::over;
  }
  /// Keeps `owner` until all other elements that become free with it are freed.
  void keep_longest(std::shared_ptr<void> owner) { retired_.keep_longest(std::move(owner)); }
  /// The elements that may be destroyed now.
  Retired take_retired() { return std::move(retired_); }

 private:
  enum class Phase : std::uint8_t { watching, going_back, withdrawing, over };

  void watch();
  [[nodiscard]] bool awaits_verdict();
  void end(Outcome::Kind kind, const std::string& reason);
  void go_back();
  [[nodiscard]] bool all_are_back() const;
  [[nodiscard]] bool may_let_go() const;
  void install_old();
  void withdraw();
  void let_go_left();
  [[nodiscard]] bool all_quiescent() const;
  void report(Outcome::Kind kind, const std::string& reason);
  [[nodiscard]] std::string culprit() const;
  void name_cores(Outcome& end) const;

  System& system_;
  std::shared_ptr<void> departed_;  // keeps tasks that are let go meanwhile
  std::shared_ptr<Content> content_;
  std::vector<MemberRollback> members_;
  std::vector<std::unique_ptr<ResourceUpdate>> updates_;
  std::shared_ptr<Rollback> rollback_;
  Retired replaced_;
  Retired retired_;
  Phase phase_ = Phase::watching;
  bool quiet_ = false;
  std::vector<std::uint64_t> generations_;
  std::weak_ptr<const void> held_;
  const std::uint64_t number_;  // of the rollback, in a trace
  Instant began_;
};

}  // namespace mauve::exec
