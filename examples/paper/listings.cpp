// SPDX-License-Identifier: LGPL-3.0-or-later
/// Listings 5 and 6 of the paper: an architecture in code, deployed on a simulated clock and
/// reconfigured while it runs.
#include <cstdio>
#include <cstdlib>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "obstacle_avoidance.h"
#include "resources.h"

namespace {

using namespace paper;

struct HokuyoShell : mauve::Shell {
  mauve::Property<std::string> device{*this, "device", ""};
  mauve::WritePort<LaserScan> scan{*this, "scan"};
};

class HokuyoCore final : public mauve::Core<HokuyoShell> {
 public:
  void update() { shell().scan.write(LaserScan{}); }
};

using Hokuyo = mauve::Component<HokuyoShell, HokuyoCore, mauve::PeriodicFsm<HokuyoCore>>;
using PotentialField =
    mauve::Component<ObstacleAvoidanceShell, PotentialFieldCore, PotentialFieldFsm>;

/// Listing 5. Components and resources are members, too.
struct NavigationArchitecture : mauve::Architecture {
  Hokuyo hokuyo{*this, "hokuyo"};
  PotentialField control{*this, "control"};

  mauve::SharedData<LaserScan> scan{*this, "scan", LaserScan{}};
  mauve::SharedData<Point2D> goal{*this, "goal", Point2D{5.0, 0.0}};
  mauve::SharedData<Pose2D> pose{*this, "pose", Pose2D{}};
  mauve::Resource<PublisherShell, PublisherCore<Velocity>, PublisherInterface<Velocity>> command{
      *this, "command"};
  mauve::Resource<mauve::EmptyShell, EkfCore, EkfInterface> localization{*this, "localization"};

  mauve::Status on_configure() override {
    hokuyo.shell().scan.connect(scan.write_service());
    control.shell().scan.connect(scan.read_service());
    control.shell().goal.connect(goal.read_service());
    control.shell().pose.connect(pose.read_service());
    control.shell().command.connect(command.interface().write);
    hokuyo.shell().device = "/dev/hokuyo";
    hokuyo.fsm().period = 25ms;
    return mauve::ok();  // the runtime then configures all elements in their order
  }
};

template <typename Done>
void must(const char* step, const Done& done) {
  std::printf("%s: %s\n", step, done ? "done" : to_string(done.error()).c_str());
  if (!done) std::exit(1);
}

}  // namespace

int main() {
  NavigationArchitecture navigation;
  mauve::Deployer deployer(navigation, {.realtime = mauve::Realtime::off, .simulated = true});
  must("deploy", deployer.deploy());
  deployer.run_for(95ms);  // control: wait_goal at 0 ms, then reach_goal each 10 ms

  // Listing 6 today: the core is prepared beside the running system, and replaced between two jobs.
  must("swap", deployer.swap_core<FiniteTimeAvoidanceCore>("control"));
  deployer.run_for(100ms);

  // Listing 6 as in the paper: the component stops, the core is replaced, the component continues
  // on the same clock. This is for a device that only one core at a time can open.
  mauve::Edit edit;
  edit.member = "control";
  edit.core = mauve::CoreType::of<PotentialFieldCore>("PotentialFieldCore");
  must("swap in place", deployer.swap_core_in_place(edit));
  deployer.run_for(100ms);

  for (const mauve::ComponentStatus& one : deployer.status()) {
    std::printf("%s: %llu jobs, %llu releases missed\n", one.name.c_str(),
                static_cast<unsigned long long>(one.releases),
                static_cast<unsigned long long>(one.missed));
  }
  std::printf("command: %llu values published\n",
              static_cast<unsigned long long>(navigation.command.core().published.get()));
}
