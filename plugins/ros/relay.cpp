// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kinds "ros/relay_TYPE": each new message of a subscriber triggers another resource.
/// The message is read from port `from` and written to port `to`, on this component's own real-time
/// thread. So neither ROS nor its thread ever calls into the robot. Example: "joy": { "type":
/// "ros/relay_joy", "ports": { "from": "joy_topic.read", "to": "teleop.joystick" } }
#include <cstdint>
#include <type_traits>

#include "parts.h"
#include "types/imu.h"
#include "types/joystick.h"
#include "types/pose.h"
#include "types/scan.h"
#include "types/velocity.h"

namespace ros_bridge {
namespace {

/// A value that moves the robot becomes a standstill when the relay stops. No default of another
/// type is safe.
template <typename T>
mauve::WritePort<T> port_to(mauve::Shell& shell) {
  if constexpr (std::is_same_v<T, rover::Velocity> || std::is_same_v<T, rover::Joystick>) {
    return {shell, "to", mauve::Safe{T{}}};
  } else {
    return {shell, "to"};
  }
}

template <typename T>
struct RelayShell : mauve::Shell {
  mauve::ReadPort<T> from{*this, "from"};
  mauve::WritePort<T> to = port_to<T>(*this);
};

template <typename T>
class Relay final : public mauve::Core<RelayShell<T>> {
 public:
  void update() {
    if (this->shell().from.read(value_) != mauve::DataStatus::new_data) return;
    if (this->shell().to.write(value_)) ++relayed;
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Observable<std::uint64_t> relayed{*this, "relayed", 0, "values handed on"};

  T value_{};
};

template <typename T>
void declare_relay(mauve::Plugin& plugin, std::string_view name) {
  plugin.component<RelayShell<T>, Relay<T>, mauve::PeriodicFsm<Relay<T>>>(name);
}

}  // namespace

void declare_relays(mauve::Plugin& plugin) {
  declare_relay<rover::Joystick>(plugin, "relay_joy");
  declare_relay<rover::Point2D>(plugin, "relay_goal");
  declare_relay<rover::Velocity>(plugin, "relay_velocity");
  declare_relay<rover::LaserScan>(plugin, "relay_scan");
  declare_relay<rover::Odometry>(plugin, "relay_odometry");
  declare_relay<rover::Pose2D>(plugin, "relay_pose");
  declare_relay<rover::Imu>(plugin, "relay_imu");
}

}  // namespace ros_bridge
