// SPDX-License-Identifier: LGPL-3.0-or-later
/// Supervision: the automatic changes of a running system. Named transactions, the rules that apply
/// them, and the components that may ask for them. Plain data, as written in the file. Any other
/// key at the top of the file that describes no element belongs here too: beside the elements only
/// the Supervision reaches describe(), compare() and the running daemon. Any difference in it ends
/// the open probations.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/host/value.h"
#include "mauve/time.h"
#include "rules/condition.h"
#include "rules/trigger.h"

namespace mauve::rules {

enum class Action : std::uint8_t { disconnect, connect, swap, set, stop, start };
/// "disconnect" and so on: the words of the file.
[[nodiscard]] std::string_view to_string(Action action);

/// One step of a transaction.
struct Step {
  Action action = Action::stop;
  std::string subject;  ///< the target: a port, a property or a component, by its address
  std::string object;   ///< of connect the service, of swap the core
  Value value;          ///< of set
  Duration max_age{0};  ///< of connect: values older than this are `stale`; zero: no limit
  bool fresh = false;   ///< of swap: the new core begins with a fresh state
};

/// All steps take effect at one instant, or none does.
using Steps = std::vector<Step>;

/// The component that a step changes: the first name of its subject.
[[nodiscard]] std::string_view element_of(const Step& step);

/// The action of a rule while its condition is unknown.
enum class Unknown : std::uint8_t { hold, fire };
/// "hold", "fire".
[[nodiscard]] std::string_view to_string(Unknown answer);

struct Rule {
  std::string name;
  Condition when;
  std::optional<Condition> until;  ///< may fire again; absent: when `when` does not hold
  Timing timing;
  std::string transaction;  ///< the one that it applies, by name; empty: `steps`
  Steps steps;
  Unknown when_unknown = Unknown::hold;
  Duration max_age{0};  ///< an older value is unknown; zero: of any age
};

struct Supervision {
  /// In the order of the file.
  std::vector<std::pair<std::string, Steps>> transactions;
  std::vector<Rule> rules;
  /// By component: the transactions that it may request.
  std::map<std::string, std::vector<std::string>, std::less<>> may_request;

  /// Null when there is none of this name.
  [[nodiscard]] const Steps* find(std::string_view transaction) const;
  [[nodiscard]] bool permits(std::string_view component, std::string_view transaction) const;
};

}  // namespace mauve::rules
