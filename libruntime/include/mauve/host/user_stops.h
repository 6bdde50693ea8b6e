// SPDX-License-Identifier: LGPL-3.0-or-later
/// UserStops: what users have stopped. A deployer asks it on every way by which a component gets to
/// run: a start, a change, a rollback, a swap in place, a deployment.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mauve {

/// A stop that a user asked for, or that only a user ends.
struct UserStop {
  std::uint32_t uid = 0;     ///< of the user
  std::string time = {};     ///< UTC, in the words of the caller
  std::uint64_t number = 0;  ///< in the order of all stops, from 1 on; the list gives it
  std::string cause = {};    ///< no user asked for it, but the host for this cause; empty: a user
};

/// The stops that stand. A component of which one stands does not run, also if it joins or comes
/// back later: only a start of it by a user ends the stop. [control]
class UserStops {
 public:
  /// From here on this stop stands.
  void stop(const std::string& component, UserStop stop);
  /// Also of components that join later.
  void stop_all(UserStop stop);
  /// Says how a start by a user ends a stop: for good, or until the change that makes it is undone.
  enum class Ends { for_good, unless_undone };
  /// A user starts the component, and `known` was the newest stop when he did: a later one stands.
  void start(const std::string& component, std::uint64_t known, Ends ends = Ends::for_good);
  /// The same for all, also for those that join later.
  void start_all(std::uint64_t known);
  /// The start that ended a stop of the component is undone. A later stop of it stays.
  void stand_again(const std::string& component);
  /// The start that ended a stop of the component can be undone no more.
  void end_for_good(const std::string& component);

  /// A stop of these components (none: of all) is being carried out until the caller lets the
  /// result go. No command may start them meanwhile.
  [[nodiscard]] std::shared_ptr<const void> begin(std::vector<std::string> components);
  [[nodiscard]] bool is_under_way(std::string_view component) const;  ///< see begin()

  /// The stop that stands against this component; null: none.
  [[nodiscard]] const UserStop* of(std::string_view component) const;
  /// The number of the newest stop, also of one that has ended; 0: there was none.
  [[nodiscard]] std::uint64_t newest() const { return newest_; }
  /// Rises with each stop and start.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// The stops of single components, by name.
  using Named = std::map<std::string, UserStop, std::less<>>;
  /// The stops that starts have ended for now: see Ends. They stand when the host ends before the
  /// changes are kept.
  [[nodiscard]] const Named& ended() const { return ended_; }
  /// Names of components.
  using Names = std::set<std::string, std::less<>>;
  /// Those that stand, beside all().
  [[nodiscard]] const Named& named() const { return named_; }
  /// The stop of all that stands, if one does.
  [[nodiscard]] const std::optional<UserStop>& all() const { return all_; }
  [[nodiscard]] const Names& started() const { return started_; }  ///< since `all()`, by name

 private:
  std::optional<UserStop> all_;
  Names started_;
  Named named_;
  Named ended_;
  std::vector<std::weak_ptr<const std::vector<std::string>>> under_way_;
  std::uint64_t newest_ = 0;
  std::uint64_t revision_ = 0;
};

}  // namespace mauve
