// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step 2 of a change: it takes effect at one instant on all members; then the books.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "exec/commit/barrier.h"
#include "exec/commit/late_jobs.h"
#include "exec/recovery/inherit.h"
#include "exec/recovery/probation_period.h"
#include "exec/swap/two_phase_commit.h"
#include "exec/system/prepared.h"
#include "exec/system/system.h"

#include <mauve/host/ongoing.h>
#include <mauve/host/receipt.h>

namespace mauve::exec {

/// A commit waits so long for its members. Each one applies its update in its present wait, or
/// after its present job.
inline constexpr Duration kLongestJob = 2s;

/// A prepared change while it takes effect. It lives in System::under_way until no member is left
/// to wait for.
class Commit final : public Ongoing, public std::enable_shared_from_this<Commit> {
 public:
  using Content = std::shared_ptr<PreparedChange::Content>;

  /// Publishes at once, or is over at once with a refusal.
  Commit(System& system, Content content, TwoPhaseCommit::Kind kind, Duration longest_job);

  bool advance() override;
  /// An unconditional update that some member does not take yet is answered, but not over.
  [[nodiscard]] bool answered() const { return result_.has_value(); }
  [[nodiscard]] bool over() const { return over_; }
  /// A part of a stop.
  [[nodiscard]] bool is_unconditional() const {
    return kind_ == TwoPhaseCommit::Kind::unconditional;
  }
  /// The commit made a generation, and its maker has not asked for the result yet.
  [[nodiscard]] bool is_unreported() const { return receipt_.generation != 0 && !reported_; }
  /// A stop of this component was asked for: it does not wait for others at a barrier.
  void give_way(const Deployed& stopped) {
    if (barrier_ != nullptr && swap_ == nullptr) barrier_->give_way(stopped);
  }
  /// The receipt of the members that have answered so far.
  [[nodiscard]] const Receipt& receipt() const { return receipt_; }
  [[nodiscard]] Result<Receipt> result() const override;
  Retired& retired() override { return retired_; }
  /// Components that did not answer in time.
  [[nodiscard]] std::vector<Deployed*> silent() const;

 private:
  Status check(TwoPhaseCommit::Kind kind);
  Status check_probations(TwoPhaseCommit::Kind kind);
  Status end_probations_before();
  Status follow(const ProbationPeriod& before);
  void overtake_before();
  Status let_in_new();
  void let_go_new();
  void hold_members();
  void add_rollback(const PreparedMember& change, Deployed& deployed, TaskUpdate& next);
  void decide_by_rollback(TaskUpdate& back);
  void roll_back_late_members();
  [[nodiscard]] bool pass_barrier();
  void publish(TwoPhaseCommit::Kind kind, Duration longest_job);
  void report_attempt();
  void report_end();
  void add_standby(std::size_t index, const Deployed& deployed, TaskUpdate& next);
  [[nodiscard]] Member make_member(std::size_t index, Deployed& deployed);
  [[nodiscard]] std::vector<ResourceMember> resource_members() const;
  void enter(std::size_t index);
  void enter_resources();
  [[nodiscard]] bool all_changed();
  void conclude();
  void trigger_rollback();
  [[nodiscard]] bool all_went_back();
  void refuse_all(Error error);
  void change_membership();
  void begin_probation();
  [[nodiscard]] std::string failed() const;
  [[nodiscard]] Error not_applied(const std::string& late) const;

  System& system_;
  std::shared_ptr<void> departed_;  // keeps tasks that are let go meanwhile
  Content content_;
  const TwoPhaseCommit::Kind kind_;
  std::vector<Deployed*> deployed_;  // by member
  std::vector<std::uint64_t> missed_before_;
  std::vector<bool> entered_;
  std::vector<StandbyCore> standby_cores_;  // by member: the one that comes with it
  std::unique_ptr<Barrier> barrier_;        // null: the cut
  std::unique_ptr<TwoPhaseCommit> swap_;    // null: not yet past the barrier
  std::optional<LateJobs> late_jobs_;       // none: not yet past the barrier
  std::shared_ptr<Rollback> rollback_;      // null: no probation
  /// The rollbacks of those earlier changes on probation that this change concerns.
  std::vector<std::shared_ptr<Rollback>> before_;
  Heritage heritage_;  // of those changes that this one joins
  std::vector<MemberRollback> rollbacks_;
  std::uint64_t number_ = 0;       // of the change, in a trace
  std::uint64_t back_number_ = 0;  // of the rollback; 0: no probation
  unsigned attempts_reported_ = 0;
  Instant back_by_ = 0;  // until then the others go back, since a member hangs; zero: none
  Receipt receipt_;
  Retired retired_;
  std::optional<Result<Receipt>> result_;
  bool over_ = false;
  mutable bool reported_ = false;  // result() was asked for the answer
};

}  // namespace mauve::exec
