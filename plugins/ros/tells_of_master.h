// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tells the log, as the component whose job uses a topic, that there is no master, or one again.
#pragma once

#include "../types/telling.h"

namespace ros_bridge {

class TellsOfMaster {
 public:
  /// [rt] At each use of the topic.
  void look(bool connected) {
    if (!there_.changed(connected)) return;
    if (connected) {
      mauve::log(mauve::LogLevel::info, "a ROS master knows its topic");
    } else {
      mauve::log(mauve::LogLevel::warning, "no ROS master knows its topic");
    }
  }

 private:
  rover::Condition there_{true};
};

}  // namespace ros_bridge
