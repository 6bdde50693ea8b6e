// SPDX-License-Identifier: LGPL-3.0-or-later
/// The change of one resource. A resource has no thread: the first caller whose job is released at
/// or after the instant applies the change under the resource's own lock. The coordinator does so
/// when no caller comes.
#pragma once

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "exec/system/resource_parts.h"
#include "exec/update/decision.h"
#include "model/element/hand_over.h"

#include <mauve/detail/binding.h>
#include <mauve/detail/resource_lock.h>
#include <mauve/host/change_policy.h>

namespace mauve {

class CoreBase;
class ObservableBase;
class PortBase;
class ResourceBase;

namespace exec {

class ResourceUpdate final : public PendingUpdate {
 public:
  enum class State : std::uint8_t {
    waiting,
    taking,
    in_force,
    dropped,  ///< aborted, revoked or never claimed: the resource is untouched
  };

  /// Arms the update: the next callers see it. The decision outlives it.
  ResourceUpdate(ResourceBase& resource, ResourceParts parts, StatePolicy state,
                 Decision& decision);
  /// Only after disarm() returned true: no caller uses it any more.
  ~ResourceUpdate() override;

  bool apply(Instant release) override;
  /// Applies the update in place of a caller once the instant has passed, unless a caller is inside
  /// the resource. [control]
  void help(Instant now);
  /// Revokes the update, unless a caller has claimed it. [control]
  void revoke();
  /// True when no caller can still be looking at it. [control]
  [[nodiscard]] bool disarm();

  [[nodiscard]] bool settled() const {
    return state() == State::in_force || state() == State::dropped;
  }
  [[nodiscard]] State state() const { return state_.load(std::memory_order_acquire); }
  [[nodiscard]] ResourceBase& resource() const { return resource_; }
  /// The parts that the update replaced; valid when it is in force.
  [[nodiscard]] const ResourceParts& replaced() const { return replaced_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Its state was not converted: it is in force and poisoned.
  [[nodiscard]] bool failed() const { return failed_; }
  /// A thread that never returned is still inside: it must not be freed.
  [[nodiscard]] bool lost() const { return lost_; }
  /// How long callers were kept out.
  [[nodiscard]] Duration pause() const { return pause_; }

 private:
  void take();
  void switch_callers();
  void finish_for_abandoned();

  ResourceBase& resource_;
  ResourceParts parts_;
  ResourceParts replaced_;
  HandOver hand_over_;
  std::vector<std::pair<ObservableBase*, const ObservableBase*>> observables_;
  Decision& decision_;
  /// Ports that lose their service: their safe values are written first.
  std::vector<std::pair<const PortBase*, const Binding*>> safe_writes_;
  std::atomic<State> state_{State::waiting};
  bool armed_ = true;
  std::atomic<bool> converting_{false};  // by a caller, which may be abandoned in it
  bool failed_ = false;
  bool lost_ = false;
  std::size_t bytes_ = 0;
  Duration pause_{0};
};

}  // namespace exec
}  // namespace mauve
