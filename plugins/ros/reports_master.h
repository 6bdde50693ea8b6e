// SPDX-License-Identifier: LGPL-3.0-or-later
/// ReportsMaster: reports in the log, as the component whose job uses a topic, that the connection
/// to the master was lost or is back.
#pragma once

#include "../types/reporting.h"

namespace ros_bridge {

class ReportsMaster {
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
