// SPDX-License-Identifier: LGPL-3.0-or-later
/// The architecture file as plain data, every item with its place in the text. Nothing here is
/// checked against plugins; see check.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arch/text/problem.h"
#include "mauve/host/task_attributes.h"
#include "mauve/host/value.h"
#include "mauve/time.h"
#include "rules/supervision.h"

namespace mauve::arch {

inline constexpr std::string_view kSchema = "mauve/architecture/1";
inline constexpr int kLowestPriority = 1;
inline constexpr int kHighestPriority = 90;  ///< above are the guard and the kernel's threads
inline constexpr int kHighestCpu = 1023;
inline constexpr unsigned kMostPerHour = 3600;  ///< firings of a rule
inline constexpr std::size_t kSmallestStack = 16 * 1024;
inline constexpr std::size_t kLargestStack = 64 * 1024 * 1024;

/// A value and where it stands.
template <typename T>
struct Placed {
  T value{};
  Position where;
};

using PlacedText = Placed<std::string>;

/// `"core.gain": 0.2`
struct PropertySpec {
  std::string name;  ///< "core.gain": group and name
  Value value;
  Position where;  ///< of the name
  Position value_where;
};

/// `"scan": "scan.read"` or `"scan": { "connect": "scan.read", "max_age": "50ms" }`
struct ConnectionSpec {
  std::string port;
  std::string service;              ///< "scan.read"
  std::optional<Duration> max_age;  ///< older values are `stale`
  Position where;                   ///< of the port's name
  Position service_where;
};

/// The part of the description that components and resources share.
struct ElementSpec {
  std::string name;
  Position where;
  PlacedText type;  ///< "drivers/laser_sim" or a built-in: "shared_data"
  std::vector<PropertySpec> properties;
  std::vector<ConnectionSpec> connections;
};

struct ResourceSpec : ElementSpec {
  std::optional<PlacedText> data;  ///< "laser_scan/1", for resources made for any data type
  std::optional<Placed<Duration>> lock_budget;
  bool cross_core = false;  ///< reserved: it is read, and not used yet
};

/// `"fallback_core": "guidance/stop"` or `{ "core": "...", "properties": { "core.gain": 0.1 } }`
struct FallbackSpec {
  PlacedText core;  ///< empty: refused, and that is reported
  std::vector<PropertySpec> properties;
};

/// The task attributes; an absent attribute has the deployer's default.
struct TaskSpec {
  Position where;
  std::optional<Placed<int>> priority;
  Placed<std::vector<int>> cpus;
  std::optional<Placed<Duration>> offset;
  std::optional<Placed<Duration>> deadline;
  std::optional<Placed<Duration>> budget;
  std::optional<Placed<std::size_t>> stack;  ///< bytes
  std::optional<Placed<OnOverrun>> on_overrun;
  std::optional<Placed<std::uint32_t>> overrun_limit;
  std::optional<Placed<FaultPolicy>> on_fault;
  std::optional<Placed<Duration>> watchdog;
};

struct ComponentSpec : ElementSpec {
  std::optional<PlacedText> core;  ///< instead of the one the type brings
  std::optional<PlacedText> fsm;
  std::optional<FallbackSpec> fallback;
  TaskSpec task;
  bool start = true;  ///< false: stays parked after deployment
  std::vector<PlacedText> may_request;
};

/// One step of a transaction; the rule layer's own form, with places.
struct StepSpec {
  rules::Step step;
  Position where;         ///< of the step
  Position object_where;  ///< of the service, core or value
};

struct TransactionSpec {
  std::string name;  ///< empty: written in the rule itself
  Position where;
  std::vector<StepSpec> steps;
};

struct ConditionSpec {
  rules::Condition value;
  Position where;
};

struct RuleSpec {
  PlacedText name;
  std::optional<ConditionSpec> when;
  std::optional<ConditionSpec> until;
  rules::Timing timing;
  rules::Unknown when_unknown = rules::Unknown::hold;
  Duration max_age{0};
  PlacedText transaction;  ///< "do" as a name; empty: `steps`
  TransactionSpec steps;   ///< "do" as a list
};

/// A whole file.
struct Spec {
  std::string name;
  std::vector<PlacedText> plugins;
  std::vector<ResourceSpec> resources;
  std::vector<ComponentSpec> components;
  std::vector<TransactionSpec> transactions;
  std::vector<RuleSpec> rules;
  /// Addresses and cores that `transactions` and `rules` may name although the system lacks them: a
  /// change of the system that was exported took them away.
  std::vector<PlacedText> lost;
};

}  // namespace mauve::arch
