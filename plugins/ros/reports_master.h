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
    there_.report(connected, "a ROS master knows its topic", "no ROS master knows its topic");
  }

 private:
  rover::Condition there_{true};
};

}  // namespace ros_bridge
