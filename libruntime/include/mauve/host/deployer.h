// SPDX-License-Identifier: LGPL-3.0-or-later
/// Deployer: turns components into real-time threads, releases them all at one instant T0 of one
/// monotonic clock, and changes them while they run (paper 3.7 and 3.9).
///
///   mauve::Deployer deployer(architecture);
///   if (mauve::Status up = deployer.deploy(); !up) ...
///   mauve::Result<mauve::Receipt> done = deployer.swap_core<FiniteTime>("control");
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <typeinfo>
#include <vector>

#include <mauve/detail/class_name.h>
#include <mauve/host/change.h>
#include <mauve/host/clock.h>
#include <mauve/host/deploy_options.h>
#include <mauve/host/ongoing.h>
#include <mauve/host/prepared_change.h>
#include <mauve/host/probation.h>
#include <mauve/host/receipt.h>
#include <mauve/host/report.h>
#include <mauve/host/retired.h>
#include <mauve/host/statistics.h>
#include <mauve/host/timing.h>
#include <mauve/host/user_stops.h>
#include <mauve/trace.h>

namespace mauve {

class Architecture;

namespace exec {
class System;
}

/// Runs an Architecture and changes it while it runs. All calls are [control] unless another thread
/// is named; none may be made from a component's thread. A refusal changes nothing.
/// @snippet api_examples.cpp Deployer
class Deployer {
 public:
  /// Deploys nothing yet. The architecture must outlive the deployer.
  explicit Deployer(Architecture& architecture, DeployOptions options = {});
  /// Shuts down.
  ~Deployer();
  Deployer(const Deployer&) = delete;
  Deployer& operator=(const Deployer&) = delete;

  /// Configures the architecture if it is not, creates all threads, releases them at T0.
  Status deploy();
  /// Stops writers before readers so that safe values still reach the hardware, then ends all
  /// threads. Never longer than `bound`: a core that hangs is abandoned, its safe values written
  /// on its behalf; the names of such components are returned. A component whose thread is not
  /// real-time may be late because the machine is loaded: once its safe values are written, it has
  /// `ordinary` more before it is abandoned. The end makes no generation.
  std::vector<std::string> shutdown(Duration bound = 2s, Duration ordinary = Duration{0});

  [[nodiscard]] Instant t0() const;          ///< the common T0, monotonic
  [[nodiscard]] const Clock& clock() const;  ///< of the releases
  /// The generation in force; `before_stops`: the newest one that no stop made.
  [[nodiscard]] std::uint64_t generation(bool before_stops = false) const;
  /// True when every component runs with the policy it asked for.
  [[nodiscard]] bool realtime() const;
  /// The real-time rights that were missing under Realtime::prefer, and the deployer's own
  /// decisions (CPUs), in words.
  [[nodiscard]] const std::vector<std::string>& warnings() const;
  [[nodiscard]] std::vector<ComponentStatus> status() const;  ///< of all components
  /// Of one component; with an empty name when there is no such component.
  [[nodiscard]] ComponentStatus status(std::string_view component) const;
  /// Response times of the running system; takes some milliseconds. `warnings()` reports the proofs
  /// that were missing at deployment under Admission::warn.
  [[nodiscard]] Timing analyze() const;

  /// The statistics of jobs, of all components.
  [[nodiscard]] std::vector<ComponentStatistics> statistics() const;
  /// The same of one component; with an empty name when there is no such component.
  [[nodiscard]] ComponentStatistics statistics(std::string_view component) const;
  /// Counts anew from the next job on; without a name of all components.
  Status reset_statistics(std::string_view component = {});

  /// Step 1 of a change: checks everything, makes and configures the new elements beside
  /// the running system. Runs user code. [factory] or [control]; an error changes nothing.
  Result<PreparedChange> prepare(const Change& change);
  /// Between steps 1 and 2: the receipt that the change would get now, without times. Its
  /// generation is the one in force.
  Receipt foresee(PreparedChange& change) const;
  /// Step 2: takes effect at one instant on all components, within about one job of each.
  [[nodiscard]] std::shared_ptr<Ongoing> begin(PreparedChange& change);
  /// Waits for the answer, at most some seconds.
  Result<Receipt> wait(Ongoing& ongoing);
  /// begin() and wait(). Elements no longer in force come back in `retired`.
  Result<Receipt> commit(PreparedChange& change, Retired& retired);
  /// prepare() and commit() in the calling thread.
  Result<Receipt> apply(const Change& change);

  /// All changes on probation are good: their old bundles may go. Refused when there is none.
  Status confirm();
  /// Back to before a change on probation, and those it joined, at the next releases of all their
  /// members. tend() reports the end. `shown`: the generations of one of probations(), which is
  /// refused when a newer change has joined it since; none: the newest change, whichever it is.
  Status undo(const std::string& reason = "undone by request",
              const std::vector<std::uint64_t>& shown = {});
  [[nodiscard]] bool on_probation() const;  ///< some change is
  /// A rollback was triggered, but some member is not back yet.
  [[nodiscard]] bool going_back() const;
  /// Those that are open or roll back, the oldest first.
  [[nodiscard]] std::vector<OpenProbation> probations() const;
  /// Looks after actions of the system by itself: probations, rollbacks, cores that took over. Call
  /// it some times a second; elements that became free go to `retired`.
  std::vector<Outcome> tend(Retired& retired);
  /// The elements that became free, without the outcomes.
  Retired collect();
  /// No thread can still use elements that a probation kept, or a core that stood by for one of
  /// them.
  [[nodiscard]] bool settled() const;

  /// The changes that prepare missing standby cores: after deployment, after each change, after
  /// each fault. Prepare each [factory], then let it stand by.
  [[nodiscard]] std::vector<Change> wanted_standby_cores() const;
  /// As prepare(); an error of a fallback core is about `X.fallback_core`.
  Result<PreparedChange> prepare_standby(const Change& standby);
  /// Lets a prepared core stand by; drops it when it is out of date meanwhile.
  void stand_by(PreparedChange& standby);
  /// No standby core can be made for this component. A component whose core has failed waits for
  /// its standby as long as its policy allows: this ends the wait, and it is faulted. `why` goes to
  /// its outcome.
  void refuse_standby(std::string_view component, const std::string& why);

  /// Shorthands for apply().
  Result<Receipt> start(const std::vector<std::string>& components, bool reset = false);
  /// Components park at the end of their job. One that does not end it gets its safe values
  /// written on its behalf, and parks as soon as it does: Errc::partly. From the call on nothing
  /// starts them but start(), or a change that ends stops: see UserStops.
  Result<Receipt> stop(const std::vector<std::string>& components);
  /// As stop(), in steps: see Ongoing. Also of a component that a rollback may bring back, see
  /// OpenProbation::removed. `by`: none: a rule stops them, and anybody may start them again.
  Result<std::shared_ptr<Ongoing>> begin_stop(const std::vector<std::string>& components,
                                              const std::optional<UserStop>& by = UserStop());
  /// Stops all components, writers of safe values before their readers, so that a driver still acts
  /// on them. A component that hangs does not hold up the rest.
  Result<Receipt> stop_all(Duration bound = 2s);
  /// As stop_all(), in steps: see Ongoing.
  [[nodiscard]] std::shared_ptr<Ongoing> begin_stop_all(Duration bound = 2s,
                                                        const UserStop& by = {});
  /// For when [control] is held up. These components (none: all) park at the end of their job with
  /// their safe values written; a job may take 2 s more. They stay parked through all changes of
  /// [control], until a stop of the same ones has begun there, or end_direct_stop(). An unknown
  /// name is null. [any], no component's thread.
  [[nodiscard]] std::unique_ptr<DirectStop> begin_direct_stop(
      const std::vector<std::string>& components);
  /// Ends begin_direct_stop().
  void end_direct_stop(const std::vector<std::string>& components);
  /// Counts how often [control] advanced the changes under way: stands still when it is held up.
  /// [any]
  [[nodiscard]] std::uint64_t looks() const;
  /// While `still`, no change is taken further, so the architecture stays as it is. Each call with
  /// true needs one with false.
  void stand_still(bool still);
  /// Replaces the core of a component while it runs.
  Result<Receipt> swap_core(std::string_view component, const CoreType& core,
                            StatePolicy state = StatePolicy::keep);
  /// The same with a core of a known class.
  template <typename T>
  Result<Receipt> swap_core(std::string_view component) {
    return swap_core(component, CoreType::of<T>(class_name(typeid(T))));
  }
  /// `address` as "control.core.gain"; also properties of resources.
  Result<Receipt> set(std::string_view address, const Value& value,
                      StatePolicy state = StatePolicy::keep);
  /// `max_age`, of read ports only: values older than this are `stale`; zero: no limit.
  Result<Receipt> connect(std::string_view port, std::string_view service,
                          Duration max_age = Duration{0});
  /// The port gets no service; its safe value is written.
  Result<Receipt> disconnect(std::string_view port);

  /// The paper's way, for hardware that one core only can hold: stop, clean up, configure, start
  /// on the same clock. In three steps, so that a daemon can run user code on its factory thread:
  /// park [control], exchange [factory], resume [control]. When the new core cannot be configured
  /// the old one is configured again and resumed, and the error of the new one is returned.
  Result<Receipt> swap_core_in_place(const Edit& edit);
  /// Parks the component. [control]
  [[nodiscard]] std::shared_ptr<Ongoing> begin_in_place_park(PreparedChange& change);
  /// Cleans up the old core and configures the new one. [factory]
  Status in_place_exchange(PreparedChange& change);
  /// Resumes the component, with the old core if `exchanged` is an error. [control]
  Result<std::shared_ptr<Ongoing>> begin_in_place_resume(PreparedChange& change,
                                                         const Status& exchanged);
  /// Step 1 of a swap in place: makes the elements but does not configure them. `made_from`: see
  /// Change. [factory]
  Result<PreparedChange> prepare_in_place(const Edit& edit,
                                          std::optional<std::uint64_t> made_from = {});
  /// Step 1 of the rollback: to the core and state machine that a swap in place cleaned up, in the
  /// bundle that the component had before. A component that has faulted runs again afterwards. The
  /// state goes along where the core before takes it. `type`: of the component before, where the
  /// swap replaced it by that of a newer build. [factory]
  Result<PreparedChange> prepare_back_in_place(std::string_view component,
                                               std::shared_ptr<const Bundle> before,
                                               std::optional<ComponentType> type = {});

  /// [log] Takes the events since the last call. One caller.
  std::size_t drain(const std::function<void(const RuntimeEvent&)>& visit);
  /// [trace] Takes the records since the last call, of each thread in their order; see
  /// mauve/trace.h. One caller, some times a second: rings overwrite records that are not
  /// collected, and the loss is a record.
  std::size_t drain_trace(const std::function<void(const TraceRecord&)>& visit);
  /// The components and resources that these records refer to, as they are now; takes some
  /// milliseconds.
  [[nodiscard]] TracedSystem traced() const;

  /// Simulated deployments: runs all jobs due in this time.
  void run_for(Duration duration);

 private:
  std::unique_ptr<exec::System> system_;
};

}  // namespace mauve
