// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/robot_sim": the robot driver on the simulated world, with the ports a
/// real one has: a velocity in, odometry, pose and twist out. It stands when no command comes, or
/// only an old one. Times of `twist` are on the monotonic clock.
#include <mauve/job.h>

#include "../../types/motion.h"
#include "../../types/pose.h"
#include "../../types/velocity.h"
#include "../parts.h"
#include "simulated_time.h"

namespace drivers {
namespace {

using rover::Odometry;
using rover::Pose2D;
using rover::Velocity;

struct RobotShell : mauve::Shell {
  mauve::ReadPort<Velocity> command{*this, "command", mauve::Need::required, mauve::Writers::one};
  mauve::WritePort<Odometry> odometry{*this, "odometry"};
  mauve::WritePort<Pose2D> pose{*this, "pose"};
  mauve::WritePort<rover::Twist> twist{*this, "twist"};
  mauve::CallPort<Odometry(Velocity, double)> drive{*this, "drive", mauve::Need::required};
};

class RobotSim final : public mauve::Core<RobotShell> {
 public:
  void update() {
    const Velocity wanted = shell().command.read();
    const mauve::DataStatus status = shell().command.status();
    const bool usable = has_value(status) && status != mauve::DataStatus::stale;
    const std::optional<Odometry> moved =
        shell().drive(usable ? wanted : Velocity{}, simulated_time(step.get()));
    if (!moved) return;
    shell().odometry.write(*moved);
    shell().pose.write({moved->x, moved->y, moved->heading});
    shell().twist.write({mauve::to_seconds(mauve::job_time()), moved->linear, moved->angular});
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<mauve::Duration> step{*this,
                                        "step",
                                        std::chrono::milliseconds(10),
                                        "simulated in each period: the same as fsm.period",
                                        {.min = std::chrono::microseconds(10), .max = {}}};
};

}  // namespace

void declare_robot_sim(mauve::Plugin& plugin) {
  plugin.component<RobotShell, RobotSim, mauve::PeriodicFsm<RobotSim>>("robot_sim");
}

}  // namespace drivers
