// SPDX-License-Identifier: LGPL-3.0-or-later
/// The differences that changes on probation made. They are kept so that the rollback can be shown
/// in the lines of `plan`, before a user asks for it and after the system did it by itself.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "mauve/host/ongoing.h"
#include "protocol/message.h"

namespace mauve::daemon {

/// [control]
class RollbackLines {
 public:
  using Json = protocol::Json;

  /// The change that made this generation made these differences ({"op","kind","address","old",
  /// "new"} each). Only the newest kMost are kept.
  void remember(std::uint64_t generation, const Json& lines);
  /// The same of a change under way, as soon as it has made its generation. The thread that
  /// waits for it remembers them when it is over.
  void expect(const std::shared_ptr<const Ongoing>& change, Json lines);
  /// The differences that going back to before these changes makes now, each address once.
  [[nodiscard]] Json back_from(const std::vector<std::uint64_t>& changes) const;
  /// False: differences of some of these changes are not kept any more.
  [[nodiscard]] bool knows(const std::vector<std::uint64_t>& changes) const;
  /// Nothing rolls back to before these changes any more.
  void forget(const std::vector<std::uint64_t>& changes);

  static constexpr std::size_t kMost = 1024;

 private:
  struct Expected {
    std::weak_ptr<const Ongoing> change;
    Json lines;
  };

  [[nodiscard]] std::map<std::uint64_t, Json> all() const;

  std::map<std::uint64_t, Json> lines_;  // by generation
  std::vector<Expected> expected_;
  std::uint64_t dropped_ = 0;  // the newest generation whose differences are not kept
};

}  // namespace mauve::daemon
