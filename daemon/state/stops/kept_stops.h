// SPDX-License-Identifier: LGPL-3.0-or-later
/// The stops of users, in a small file of their own in the state directory. It is written before
/// all that waits for the disk, so an answered stop outlives a crash at any moment, also when the
/// process has no free descriptor.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "log/log.h"
#include "mauve/host/user_stops.h"
#include "state/stops/kept_file.h"

namespace mauve::daemon {

class KeptStops {
 public:
  using Then = std::function<void(bool saved)>;
  using Order = std::shared_ptr<const void>;

  KeptStops(const std::filesystem::path& directory, logging::Log& log);

  /// The list that the last run left. One that cannot be read stops all. [main]
  [[nodiscard]] UserStops read() const;
  /// The next write() has this list, then calls `then`. [any but rt]
  void keep(const UserStops& now, Then then = {});
  /// A stop that [control] has not come to yet: it is added to each list until served(). No
  /// components: all. `order` tells such stops apart. [any but rt]
  void keep_directly(const Order& order, const std::vector<std::string>& components,
                     const UserStop& by, Then then);
  /// [control] has come to it, and has given a list that has it. [any but rt]
  void served(const Order& order);
  /// Puts the newest list on the disk, if it is not there yet. False: the disk did not take it.
  /// [main] before [disk] begins, then [disk]
  bool write();

 private:
  struct Direct {
    std::vector<std::string> components;
    UserStop by;
  };

  [[nodiscard]] UserStops list() const MAUVE_REQUIRES(mutex_);
  Status put(const UserStops& list);

  KeptFile file_;
  logging::Log& log_;
  mutable Mutex mutex_;  ///< guards the members below
  UserStops now_ MAUVE_GUARDED_BY(mutex_);
  std::map<Order, Direct> direct_ MAUVE_GUARDED_BY(mutex_);
  /// Late reports of these add nothing.
  std::set<std::weak_ptr<const void>, std::owner_less<>> served_ MAUVE_GUARDED_BY(mutex_);
  std::vector<Then> waiting_ MAUVE_GUARDED_BY(mutex_);
  bool written_ MAUVE_GUARDED_BY(mutex_) = false;  ///< the newest list is on the disk
};

}  // namespace mauve::daemon
