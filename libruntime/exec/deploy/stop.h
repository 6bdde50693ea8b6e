// SPDX-License-Identifier: LGPL-3.0-or-later
/// Stop: parks components at the end of the job they are in. It cannot be refused and does not need
/// the component to be well. [control] writes the safe values of a component that is late, in its
/// job or for want of a processor, and it parks as soon as its job ends.
#pragma once

#include <set>
#include <vector>

#include "exec/commit/commit.h"

#include <mauve/host/ongoing.h>
#include <mauve/host/receipt.h>

namespace mauve::exec {

/// Components that may park at the same time; a stage begins when the one before has ended.
using Stages = std::vector<std::vector<Deployed*>>;

/// Stops components for a user. The stop stands from this call on, also against a change under way.
/// Without a user nothing stands against their next start.
[[nodiscard]] Result<std::shared_ptr<Ongoing>> begin_stop(
    System& system, const std::vector<std::string>& components, const std::optional<UserStop>& by);
[[nodiscard]] std::shared_ptr<Ongoing> begin_stop_all(System& system, Duration bound, UserStop by);

/// Components that write safe values stop before those that read them. One that holds a guarded
/// output waits for none: its order makes the device safe.
[[nodiscard]] Stages in_order_of_safe_values(System& system);

/// Stops all stages in turn. Between two stages, components of later stages that will soon read the
/// outputs of the stopped ones get one more job to act on them.
class Stop final : public Ongoing {
 public:
  /// `patience`: how long a component may take to end its job. `names`: of the components, or none
  /// for all. Nothing starts them before this is over.
  Stop(System& system, Stages stages, Duration patience, std::vector<std::string> names = {});

  bool advance() override;
  [[nodiscard]] Result<Receipt> result() const override;
  Retired& retired() override { return nothing_; }
  /// Those that did not come to a boundary in time.
  [[nodiscard]] const std::set<const Deployed*>& hung() const { return hung_; }

 private:
  enum class Phase : std::uint8_t { parking, reading, over };

  void begin_stage();
  void park_free();
  [[nodiscard]] bool parked();
  void take_answer(const Commit& commit);
  void make_safe_early();
  void stop_waiting_for(Deployed& deployed);
  void begin_reading();
  [[nodiscard]] bool readers_have_read() const;

  System& system_;
  std::shared_ptr<const void> under_way_;
  std::shared_ptr<void> departed_;  // keeps tasks that are let go meanwhile
  Stages stages_;
  const Duration patience_;
  Phase phase_ = Phase::parking;
  std::size_t stage_ = 0;
  Instant safe_by_ = 0;
  Instant patient_until_ = 0;
  std::vector<Deployed*> waiting_;  // for a change of theirs to be over, also from stages before
  std::vector<std::shared_ptr<Commit>> commits_;
  std::vector<std::pair<const Deployed*, std::uint64_t>> readers_;  // and their releases before
  Instant read_by_ = 0;
  Receipt receipt_;
  std::set<const Deployed*> late_;  // their safe values are written
  std::set<const Deployed*> hung_;
  Retired nothing_;
};

}  // namespace mauve::exec
