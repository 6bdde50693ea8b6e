// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes that meet while one of them is on probation. One that concerns nothing of it leaves it
/// alone. One that changes its components again joins it: both have one rollback, which leads to
/// before the older one. A member of the older change that the newer one leaves as it is follows:
/// it takes the new rollback together with the others. A change that can do neither ends the
/// probation early.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "exec/system/prepared.h"
#include "exec/system/system.h"

namespace mauve::exec {

struct MemberRollback;

/// Does the change need anything that the rollback of the change before would take away, or take
/// away anything that the rollback needs? [control]
[[nodiscard]] bool concerns(const System& system, const PreparedChange::Content& change,
                            const PreparedChange::Content& before);
/// Starts and parks components, and nothing else: the rollback stays true.
[[nodiscard]] bool changes_modes_only(const PreparedChange::Content& change);
/// Can the change join the change before? Else it ends the probation of that one. Code that comes
/// without a probation, for instance by a reload, cannot join: no rollback may lead back over it.
[[nodiscard]] bool can_join(const PreparedChange::Content& change,
                            const PreparedChange::Content& before);

/// The members, origins and changes that a change takes over from the changes it joins, while it
/// takes effect.
class Heritage {
 public:
  void add(ProbationPeriod& before);
  /// The state to which this component is rolled back; null: its state before this change.
  [[nodiscard]] const Origin* origin_of(const ComponentBase& component) const;
  [[nodiscard]] bool has(const Rollback& before) const;
  /// The generations of the changes it joins.
  [[nodiscard]] const std::vector<std::uint64_t>& generations() const { return generations_; }
  /// The changes before may end.
  void let_go() { held_.clear(); }

 private:
  struct Member {
    const ComponentBase* component;
    Origin origin;
  };
  std::vector<Member> members_;
  std::vector<const Rollback*> rollbacks_;
  std::vector<std::shared_ptr<const void>> held_;
  std::vector<std::uint64_t> generations_;
};

/// The origin of a rollback over both changes: `now` is that of `change` alone.
[[nodiscard]] Origin further_back(const Origin& before, const Origin& now,
                                  const PreparedMember& change);

/// `heir`, which joined the change `before` and is in force, becomes the change from before both to
/// now. Elements of `before` that are needed neither now nor on the rollback go to `retired`.
/// `members`: which of those of `heir` are in force.
void adopt(PreparedChange::Content& before, PreparedChange::Content& heir,
           const std::vector<MemberRollback>& members, Retired& retired);

/// Retires the cores in between that kept a state for the rollback of these members, which is over.
void retire_kept(std::vector<MemberRollback>& members, const PreparedChange::Content& change,
                 Retired& retired);

/// The same when `heir` has joined the change and is in force: its rollback, that of the members
/// `heirs`, may need the state as well.
void retire_kept(std::vector<MemberRollback>& members, const PreparedChange::Content& change,
                 const PreparedChange::Content& heir, const std::vector<MemberRollback>& heirs,
                 Retired& retired);

/// In sentences: the states that are kept unexamined or that a rollback cannot bring back, and the
/// open probations that the change joins or ends early. [control]
[[nodiscard]] std::vector<std::string> notes_of(const System& system,
                                                const PreparedChange::Content& change);

}  // namespace mauve::exec
