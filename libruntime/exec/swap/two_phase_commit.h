// SPDX-License-Identifier: LGPL-3.0-or-later
/// The swap: how a change takes effect on N components at one logical instant.
///
///   coordinator [control], in attempt():
///     It chooses the instant tc on the common clock, and puts an update into each mailbox.
///     It decides: CAS prepared -> committed, or prepared -> aborted when tc is too near.
///     It wakes all members.
///
///   member [rt], whose next release is r, in Boundary::serve(), after each job and each wake-up:
///     Aborted: it gives the update back.
///     Committed, r >= tc, and r is not due: it takes the update, and answers.
///
///   member [rt], in Boundary::cross(), when r is due:
///     r < tc: the job of r is old.
///     r >= tc, not committed: CAS prepared -> aborted, the update goes back, the job of r is old.
///     r >= tc, committed: it takes the update, runs the job of r, and answers.
///
/// The first transition of the state decides for all: jobs released before tc are old everywhere,
/// at or after tc new everywhere, or nothing happened. The common case is serve(): a member between
/// two jobs takes the update there, even before tc, and so does a member that does not run,
/// whatever r is. A simulation calls serve() at wake-ups only. No member ever waits for another,
/// and the coordinator only looks now and then at their progress. A resource has no thread: see
/// resource_update.h.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "exec/swap/resource_update.h"
#include "exec/update/task_update.h"

namespace mauve::exec {

class Runner;
class Task;

/// One component's part in a swap.
struct Member {
  Task* task = nullptr;
  std::unique_ptr<TaskUpdate> next;  ///< while no task owns it
  TaskUpdate* update = nullptr;      ///< while a task owns it; freed once the task has left it
  std::shared_ptr<const TaskUpdate::Answer> answer;  ///< of `update`; outlives it
  bool settled = false;   ///< its thread has answered, or the coordinator does not wait any more
  bool in_force = false;  ///< it runs with the update, or has claimed it
  Duration pause{0};      ///< its next job begins at most so much later
  std::size_t bytes = 0;  ///< of the state that was handed over
  bool failed = false;    ///< it runs with the update, but its state was not converted
};

/// One resource's part.
struct ResourceMember {
  ResourceBase* resource = nullptr;
  ResourceParts parts;
  StatePolicy state = StatePolicy::keep;
  std::unique_ptr<ResourceUpdate> update;  ///< of this attempt
};

struct SwapResult {
  enum class State : std::uint8_t {
    under_way,
    committed,
    missed,     ///< every attempt missed its instant: nothing happened
    revoked,    ///< no member reached a boundary in time: nothing happened
    partly,     ///< some member did not reach a boundary in time, others did
    overtaken,  ///< the change before is rolled back: nothing happened
    waiting,    ///< unconditional: some member did not reach a boundary yet, it will take it then
  };
  State state = State::under_way;
  Instant instant = 0;
  unsigned attempts = 0;
};

inline constexpr unsigned kMaxAttempts = 5;

/// A swap under way. [control]
class TwoPhaseCommit {
 public:
  enum class Kind : std::uint8_t {
    change,         ///< all members or none; revoked when no member came in time
    unconditional,  ///< decided beforehand and never revoked: a stop cannot fail
  };

  /// Publishes and decides. `bound`: how long after the instant members may take to answer.
  /// `before`: rollbacks that can no longer be triggered once this is committed.
  TwoPhaseCommit(std::vector<Member> members, std::vector<ResourceMember> resources, Runner& runner,
                 Duration bound, Kind kind, std::vector<std::shared_ptr<Rollback>> before = {});
  ~TwoPhaseCommit();
  TwoPhaseCommit(const TwoPhaseCommit&) = delete;
  TwoPhaseCommit& operator=(const TwoPhaseCommit&) = delete;

  /// Settles the members that have answered; tries again after a missed instant; stops waiting when
  /// the time is over. Never waits. True when no member is left to wait for.
  bool advance();
  /// Revokes the updates that no task has claimed yet, before the time is over.
  void call_off() {
    if (result_.state == SwapResult::State::under_way) stop_waiting();
  }
  [[nodiscard]] const SwapResult& result() const { return result_; }
  /// Of the newest attempt.
  [[nodiscard]] Decision::State decision() const { return decisions_.back()->state(); }
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  [[nodiscard]] const std::vector<ResourceMember>& resources() const { return resources_; }

 private:
  void attempt();
  void publish(Member& member);
  void arm(ResourceMember& resource);
  void settle(Member& member);
  static void take_back(Member& member);
  void stop_waiting();
  void stop_waiting(Member& member, bool committed);
  [[nodiscard]] bool all_settled();
  [[nodiscard]] bool is_taking() const;
  [[nodiscard]] bool is_rolled_back() const;

  std::vector<Member> members_;
  std::vector<ResourceMember> resources_;
  std::vector<std::unique_ptr<ResourceUpdate>> old_updates_;  // a caller may still be inside
  Runner& runner_;
  const Duration bound_;
  const Kind kind_;
  const std::vector<std::shared_ptr<Rollback>> before_;
  bool stopped_waiting_ = false;
  Duration lead_;
  Instant deadline_ = 0;
  std::vector<std::shared_ptr<Decision>> decisions_;  // the newest counts
  SwapResult result_;
};

}  // namespace mauve::exec
