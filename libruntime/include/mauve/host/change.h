// SPDX-License-Identifier: LGPL-3.0-or-later
/// Change: the difference that a running architecture is to get.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <mauve/detail/element_type.h>
#include <mauve/host/change_policy.h>
#include <mauve/host/component.h>
#include <mauve/host/probation.h>
#include <mauve/host/user_stops.h>
#include <mauve/host/value.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

class PropertyBase;
class ResourceBase;

/// A port and the service it is to be connected to.
struct NewConnection {
  std::string port;     ///< name inside the component: "scan"
  std::string service;  ///< address: "scan.read"
  Duration max_age{0};  ///< values older than this are `stale`; zero: no limit
};

/// The change of one component or resource. Everything that it does not name stays as it is.
struct Edit {
  std::string member;            ///< the component or resource
  std::optional<CoreType> core;  ///< replaces the core; also the core in force again, freshly made
  std::optional<FsmType> fsm;    ///< replaces the state machine
  /// The component's own type from a newer build of its plugin: its shell is made anew, connections
  /// are kept by name of the port.
  std::optional<ComponentType> type;
  /// Of a resource: its own type from a newer build of its plugin. The resource is made anew and
  /// takes over at a barrier, where all its users wait for each other. A resource is made anew in
  /// the same way when a property of its shell or interface changes.
  std::optional<ResourceType> resource = {};
  /// "core.gain", "fsm.pace", "shell.device" -> value.
  std::vector<std::pair<std::string, Value>> properties;
  std::vector<NewConnection> connect;   ///< ports that get another service
  std::vector<std::string> disconnect;  ///< names of ports
  std::optional<TaskAttributes> task;   ///< all of them; `start` is not looked at, see `mode`
  /// Of a resource: the longest that one call keeps its lock; zero takes the declaration back.
  std::optional<Duration> lock_budget = {};
  Mode mode = Mode::keep;                 ///< starts, stops, or neither
  StatePolicy state = StatePolicy::keep;  ///< the fate of the state
  Values values = Values::keep;           ///< properties that are not named
  /// Asked for each of `properties` before the property gets its value and before any hook runs; a
  /// refusal refuses the change. None: every value that the property accepts. [factory]
  std::function<Status(const PropertyBase&, const Value&)> allows = {};
};

/// A resource or component that joins: made, its properties set, neither configured nor connected.
/// Its ports may be connected to services that are there after the change.
struct NewResource {
  std::shared_ptr<ResourceBase> resource;  ///< made, with its properties set
  std::vector<NewConnection> connect;      ///< of its own ports
  StatePolicy state = StatePolicy::keep;   ///< of the resource that leaves under its name
};
/// The same for a component.
struct NewComponent {
  std::shared_ptr<ComponentBase> component;  ///< made, with its properties set
  std::vector<NewConnection> connect;        ///< of its ports
};

/// Another fallback core for a component, or none.
struct NewFallback {
  std::string component;                            ///< one that is changed
  std::optional<ComponentBase::Fallback> fallback;  ///< none: takes it away
};

/// All of it takes effect at one logical instant, or nothing does.
struct Change {
  std::vector<Edit> edits;                        ///< of components and resources that stay
  std::vector<NewResource> new_resources = {};    ///< that join
  std::vector<NewComponent> new_components = {};  ///< that join
  /// Components and resources that leave. A name that leaves may join again as something else.
  std::vector<std::string> remove = {};
  std::optional<Probation> probation = {};  ///< none: no rollback
  Sync sync = Sync::cut;                    ///< how members meet
  std::vector<NewFallback> fallbacks = {};  ///< of components that stay
  /// Something outside of the runtime changes with it, for instance rules: a change that is empty
  /// otherwise makes a generation too, and may be on probation.
  bool changes_rules = false;
  /// A user names the components that it starts: their stops end when it is in force. Else a
  /// component that a user has stopped stays stopped, whatever `mode` says.
  bool ends_stops = false;
  /// Components that a user stops with the change, also if they stand already. These stops stand
  /// from the begin of the change on (see UserStops), unless it is not put in force.
  std::vector<std::string> stops = {};
  UserStop stopped_by = {};  ///< of `stops`
  /// The generation that the change was made from, see Deployer::generation(before_stops): the
  /// change is refused when another one is in force, for example after a rollback. None: made from
  /// the change alone.
  std::optional<std::uint64_t> made_from = {};
};

}  // namespace mauve
