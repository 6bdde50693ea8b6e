// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step 2 of a change: it takes effect at one instant on all members; then the books.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "exec/prepared.h"
#include "exec/swap.h"
#include "exec/system.h"

namespace mauve::exec {

/// After the decision a member takes its bundle in the wait it is in, or after the job it is in.
inline constexpr Duration kLongestJob = 2s;

/// What the task of this member is handed.
[[nodiscard]] std::unique_ptr<Published> make_published(const PreparedMember& member);

/// A prepared change taking effect. Lives in System::under_way until no member is left to wait for.
class Commit final : public Ongoing {
 public:
  using Content = std::shared_ptr<PreparedChange::Content>;

  /// Publishes at once, or is over at once with a refusal.
  Commit(System& system, Content content, Swap::Kind kind, Duration longest_job);

  bool advance() override;
  /// An order that some member does not obey yet is answered, but not over.
  [[nodiscard]] bool answered() const { return result_.has_value(); }
  [[nodiscard]] bool over() const { return over_; }
  /// Of the members that have answered so far.
  [[nodiscard]] const Receipt& receipt() const { return receipt_; }
  [[nodiscard]] Result<Receipt> result() const override;
  Retired& retired() override { return retired_; }
  /// Components that did not answer in time.
  [[nodiscard]] std::vector<Deployed*> silent() const;

 private:
  Status check() const;
  void publish(Swap::Kind kind, Duration longest_job);
  void enter(std::size_t index);
  void conclude();
  void commit_resources();
  [[nodiscard]] Error not_applied() const;

  System& system_;
  Content content_;
  std::vector<Deployed*> deployed_;  // by member
  std::vector<std::uint64_t> missed_before_;
  std::vector<bool> entered_;
  std::unique_ptr<Swap> swap_;  // null: no component is a member
  Receipt receipt_;
  Retired retired_;
  std::optional<Result<Receipt>> result_;
  bool over_ = false;
};

/// Begins the commit; it goes on while anybody calls advance().
std::shared_ptr<Commit> begin_commit(System& system, PreparedChange& change,
                                     Swap::Kind kind = Swap::Kind::transaction,
                                     Duration longest_job = kLongestJob);

}  // namespace mauve::exec
