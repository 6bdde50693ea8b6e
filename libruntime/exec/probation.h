// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probation: after a commit the old bundles stay ready, and the way back to them is prepared, so
/// that a member that fails leads all members back at their next release without asking anybody.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exec/prepared.h"
#include "exec/system.h"

#include <mauve/deployer.h>

namespace mauve::exec {

/// The way back of one member, which is handed out together with the way forth.
struct WayBackOfMember {
  Deployed* deployed = nullptr;
  Origin origin;
  Published* back = nullptr;  ///< owned by the way forth, then by the task
  std::shared_ptr<const Published::Answer> answer;
  std::uint64_t releases_before = 0;
  std::uint64_t looks_after = 0;  ///< when it was withdrawn
  std::unique_ptr<Published> withdrawn;
  bool in_force = true;            ///< the change is
  std::uint64_t last_release = 0;  ///< until which it may be judged; 0: its time has not passed
};

/// One change on probation, or several that joined each other. [control]
class OnProbation {
 public:
  using Content = PreparedChange::Content;

  /// Of a change that is committed: its content, and the elements it replaced. `joined`: the
  /// generations of the changes that it joined.
  OnProbation(System& system, std::shared_ptr<Content> content,
              std::vector<WayBackOfMember> members, std::shared_ptr<WayBack> way_back,
              Retired replaced, std::uint64_t number, std::vector<std::uint64_t> joined = {});
  ~OnProbation();

  /// Looks whether it is over. The end is told in System::outcomes; false: nothing of it is left.
  bool advance();
  /// Nobody can fail any more: the change stays. False: it is being rolled back already.
  bool pass(const std::string& reason, Outcome::Kind kind = Outcome::Kind::passed);
  /// A newer change is in force, to which the way back gave way.
  void overtake();
  /// A newer change is in force that leads its members back from now on. Elements that neither it
  /// nor the way back needs are freed with this; what it replaced is the heir's.
  void pass_on_to(Content& heir, const std::vector<WayBackOfMember>& members);
  /// As long as the caller holds this it does not end, except by a failure or undo().
  [[nodiscard]] std::shared_ptr<const void> hold();
  [[nodiscard]] const PreparedChange::Content& content() const { return *content_; }
  [[nodiscard]] const std::vector<WayBackOfMember>& members() const { return members_; }
  /// The generations that its changes made, the oldest first.
  [[nodiscard]] const std::vector<std::uint64_t>& changes() const { return changes_; }
  [[nodiscard]] OpenProbation look() const;
  [[nodiscard]] const std::shared_ptr<WayBack>& way_back() const { return way_back_; }
  /// False: it is over, or being rolled back already.
  bool undo(const std::string& reason);
  /// Everything stops: who comes back by a rollback does not start again.
  void keep_parked();
  /// Of a change that is not even in force everywhere: it never made a generation.
  void go_quietly() { quiet_ = true; }
  /// Unless going back takes too long.
  void tell_after_all();
  [[nodiscard]] bool leads(const WayBack& back) const {
    return way_back_.get() == &back && !told();
  }
  [[nodiscard]] bool open() const { return phase_ == Phase::watching && way_back_->open(); }
  [[nodiscard]] bool awaits_confirmation() const;
  /// Its end is in System::outcomes; all that remains is to wait until no thread looks at it.
  [[nodiscard]] bool told() const { return phase_ == Phase::withdrawing || phase_ == Phase::over; }
  /// Is freed after all that becomes free with it.
  void keep_longest(std::shared_ptr<void> owner) { free_.keep_longest(std::move(owner)); }
  /// What became free.
  Retired take_free() { return std::move(free_); }

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
  [[nodiscard]] bool all_looked_away() const;
  void tell(Outcome::Kind kind, const std::string& reason);
  [[nodiscard]] std::string culprit() const;
  void name_cores(Outcome& end) const;

  System& system_;
  std::shared_ptr<void> departed_;  // keeps tasks that are let go meanwhile
  std::shared_ptr<Content> content_;
  std::vector<WayBackOfMember> members_;
  std::vector<std::unique_ptr<ResourceFlip>> flips_;
  std::shared_ptr<WayBack> way_back_;
  Retired replaced_;
  Retired free_;
  Phase phase_ = Phase::watching;
  bool quiet_ = false;
  std::vector<std::uint64_t> changes_;
  std::weak_ptr<const void> held_;
  const std::uint64_t number_;  // of the way back, in a trace
  Instant began_;
};

}  // namespace mauve::exec
