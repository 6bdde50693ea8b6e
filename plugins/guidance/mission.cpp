// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "guidance/mission": gives the goal, until there is a planner. Example: mauvectl
/// set 'mission.core.goal={"x":8,"y":4}'
#include "cores.h"

namespace guidance {
namespace {

struct MissionShell : mauve::Shell {
  mauve::WritePort<Point2D> goal{*this, "goal"};
};

class Mission final : public mauve::Core<MissionShell> {
 public:
  void update() { shell().goal.write(goal); }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<Point2D> goal{*this, "goal", {}, "where to go, m"};
};

}  // namespace

void declare_mission(mauve::Plugin& plugin) {
  plugin.component<MissionShell, Mission, mauve::PeriodicFsm<Mission>>("mission");
}

}  // namespace guidance
