// SPDX-License-Identifier: LGPL-3.0-or-later
/// The values of some addresses over a time: the source of CSV and pictures.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/session.h"

namespace mauve::ctl {

/// One plain value within the value of an address: x of pose.read.
struct Channel {
  std::string address;
  std::vector<std::string> path;  ///< members that lead to it; empty: the value itself
  std::string unit;

  /// "pose.read.x"
  [[nodiscard]] std::string name() const;
  /// The value within a sample of its address; null when there is none.
  [[nodiscard]] Json in(const Json& value) const;
};

/// The channels of the value at the address, in the order of its description.
[[nodiscard]] std::variant<std::vector<Channel>, Fault> channels_of(Session& session,
                                                                    const std::string& address);

struct Sample {
  double time = 0.0;  ///< s since the system's T0
  std::string address;
  Json value;  ///< null: values were lost, the watcher was too slow
};

/// Hands out the values that arrive until --for has passed or Ctrl-C was pressed. [main]
[[nodiscard]] std::optional<Fault> follow(Session& session,
                                          const std::vector<std::string>& addresses,
                                          const std::function<void(const Sample&)>& take);

}  // namespace mauve::ctl
