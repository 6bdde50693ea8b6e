// SPDX-License-Identifier: LGPL-3.0-or-later
/// Change: what is to become different in a running architecture, and the receipt for it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <mauve/component.h>
#include <mauve/element_type.h>
#include <mauve/property.h>
#include <mauve/time.h>
#include <mauve/value.h>

namespace mauve {

class ResourceBase;

/// What happens to the state of a core that is replaced.
enum class StatePolicy : std::uint8_t {
  keep,   ///< hand it over; refused when the new core can neither take nor convert it
  offer,  ///< the same, but a core that is `Stateless` may leave it: of reactions to a fault
  drop,   ///< the new core starts fresh
};

/// Where the properties of a core begin that replaces one of another type. Properties that the edit
/// sets, or of which the other core has none of that name, are not asked.
enum class Values : std::uint8_t {
  keep,      ///< with the values in force; refused when one has another type or unit there, or is
             ///< out of range
  fit,       ///< with the values in force that fit; the others with their defaults
  defaults,  ///< all with their defaults
};

/// When the members of a change go on.
enum class Sync : std::uint8_t {
  /// Each at its own first release at or after the instant; nobody waits for anybody.
  cut,
  /// All members wait at a boundary until the last one is there; then a resource that leaves hands
  /// its state to the one that joins under its name, and all go on at their next releases. For
  /// changes of a contract between members.
  barrier,
};

/// What one component is to do after the change.
enum class Mode : std::uint8_t { keep, run, park };

/// A port and the service it is to be connected to.
struct NewConnection {
  std::string port;     ///< name inside the component: "scan"
  std::string service;  ///< address: "scan.read"
  Duration max_age{0};  ///< values older than this are `stale`; zero: no limit
};

/// The change of one component or resource. Everything not said stays as it is.
struct Edit {
  std::string component;         ///< or resource
  std::optional<CoreType> core;  ///< replaces the core; also the core in force again, freshly made
  std::optional<FsmType> fsm;    ///< replaces the state machine
  /// The component's own type from a newer build of its plugin: its shell is made anew, connections
  /// are kept by name of the port.
  std::optional<ComponentType> type;
  /// Of a resource: its own type from a newer build of its plugin. Like one of which a property of
  /// the shell or interface changes it is made anew, and takes over at a barrier: all that use it
  /// wait for each other.
  std::optional<ResourceType> resource = {};
  /// "core.gain", "fsm.pace", "shell.device" -> value.
  std::vector<std::pair<std::string, Value>> properties;
  std::vector<NewConnection> connect;
  std::vector<std::string> disconnect;  ///< names of ports
  std::optional<TaskAttributes> task;   ///< all of them; `start` is not looked at, see `mode`
  /// Of a resource: the longest that one call keeps its lock; zero takes the declaration back.
  std::optional<Duration> hold = {};
  Mode mode = Mode::keep;
  StatePolicy state = StatePolicy::keep;
  Values values = Values::keep;
  /// Asked for each of `properties` before the property gets its value and before any hook runs; a
  /// refusal refuses the change. None: every value that the property accepts. [factory]
  std::function<Status(const PropertyBase&, const Value&)> allows = {};
};

/// A resource or component that joins: made, its properties set, neither configured nor connected.
/// Its ports may be connected to what is there after the change.
struct NewResource {
  std::shared_ptr<ResourceBase> resource;
  std::vector<NewConnection> connect;
  StatePolicy state = StatePolicy::keep;  ///< of what leaves under its name, at a barrier
};
struct NewComponent {
  std::shared_ptr<ComponentBase> component;
  std::vector<NewConnection> connect;
};

/// Another core, or none, that takes over when the one of this component fails.
struct NewFallback {
  std::string component;  ///< one that is changed
  std::optional<ComponentBase::Fallback> fallback;
};

/// After the commit the old bundles stay ready until every member ran so many jobs with the new
/// ones, or for so long, whichever is first. A core that fails (it throws, crashes, hangs, writes
/// an implausible value) leads back to them at the next release. So does a core that takes too
/// long; that needs several jobs as evidence (exec/evidence.h), and the probation goes on for some
/// jobs while a core is under suspicion.
///
/// A change of other components leaves a probation as it is. A newer change of the same components
/// joins it: the time begins anew, and a failure leads all of them back to before the first change,
/// which is what was proven last. A change that also changes resources ends it early instead.
struct Probation {
  std::uint64_t activations = 3000;  ///< rule of three: fails less than once in 1000 at 95 %
  Duration time{10s};
  Duration confirm_within{0};  ///< zero: nobody needs to confirm
  /// Late jobs of a member that are tolerated in `window` jobs of it. At least 1: a single late job
  /// is no evidence.
  unsigned misses = 2;
  unsigned window = 64;  ///< at most 64
};

/// All of it takes effect at one logical instant, or nothing does.
struct Change {
  std::vector<Edit> edits;
  std::vector<NewResource> new_resources = {};
  std::vector<NewComponent> new_components = {};
  /// Components and resources that leave. A name that leaves may join again as something else.
  std::vector<std::string> remove = {};
  std::optional<Probation> probation = {};
  Sync sync = Sync::cut;
  std::vector<NewFallback> fallbacks = {};
  /// Something outside of the runtime changes with it, for instance rules: a change that is empty
  /// otherwise makes a generation too, and may be on probation.
  bool has_companion = false;
  /// The generation that the change was made from: prepare() refuses the change when another one is
  /// in force, for example after a rollback. None: made from the change alone.
  std::optional<std::uint64_t> made_from = {};
};

/// What a change cost one component.
struct MemberReceipt {
  std::string name;
  Duration pause{0};         ///< measured on its thread: its next job begins at most so much later
  std::uint64_t missed = 0;  ///< releases lost between the instant and its first job after it
  std::size_t bytes = 0;     ///< size of the state handed over
  /// The types of the states that were dropped, "a and b", and the size of their objects.
  std::string dropped = {};
  std::size_t dropped_bytes = 0;
};

enum class ChangeState : std::uint8_t { unchanged, applied, rolled_back, safe };
[[nodiscard]] std::string_view to_string(ChangeState state);

/// Answer to every change.
struct Receipt {
  std::uint64_t generation = 0;  ///< in force now
  ChangeState state = ChangeState::unchanged;
  Duration commit{0};     ///< logical instant of the change, since T0
  unsigned attempts = 0;  ///< tries until the coordinator met its instant
  std::vector<MemberReceipt> components;
  std::vector<std::string> warnings = {};  ///< why it was not admitted, see Admission::warn
  /// Consequences for probations that are open: which this change joins, which it ends early.
  std::vector<std::string> notes = {};
};

}  // namespace mauve
