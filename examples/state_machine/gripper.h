// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "gripper/gripper": it waits for a part, closes until the force is reached, holds
/// the part, and opens again. Each phase has a wait of its own.
#pragma once

#include <mauve/plugin.h>

namespace gripper {

struct Shell : mauve::Shell {
  mauve::ReadPort<bool> part{*this, "part"};      // a part lies between the jaws
  mauve::ReadPort<double> force{*this, "force"};  // N
  mauve::WritePort<double> current{*this, "current", mauve::Safe{0.0}};  // A, closes the jaws
};

/// The core says what each state does. It knows nothing of time.
class Core final : public mauve::Core<Shell> {
 public:
  mauve::Property<double> grip_force{
      *this, "grip_force", 5.0, "enough to hold the part", {.unit = "N", .min = 0.0, .max = 50.0}};
  mauve::Property<double> step{*this,
                               "step",
                               0.25,
                               "more current in each job of state close",
                               {.unit = "A", .min = 0.0, .max = 1.0}};
  mauve::State<double> current{*this};  // A
  mauve::Observable<int> gripped_parts{*this, "gripped_parts", 0, "since the start"};

  // [rt] The execution states.
  void watch() { part_there_ = shell().part.read(); }
  void close() { shell().current.write(*current += step); }
  void hold() { ++gripped_parts; }
  void open() { shell().current.write(*current = 0.0); }

  // [rt] The guards of the transitions.
  bool part_there() const { return part_there_; }
  bool gripped() { return shell().force.read() >= grip_force; }

 private:
  bool part_there_ = false;
};

/// The state machine says when. A job runs execution states up to the next synchronization state,
/// whose duration is the time from the release of this job to the release of the next one.
struct Fsm : mauve::Fsm<Core> {
  Exec watch{*this, "watch", &Core::watch};
  Exec close{*this, "close", &Core::close};
  Exec hold{*this, "hold", &Core::hold};
  Exec open{*this, "open", &Core::open};
  Sync idle{*this, "idle", 50ms, "between two looks for a part"};
  Sync pace{*this, "pace", 5ms, "between two steps of the current"};
  Sync held{*this, "held", 200ms, "how long the part is held"};
  Sync opening{*this, "opening", 100ms, "until the jaws are open"};

  mauve::Status on_configure() override {
    start_at(watch);
    watch.when("part_there", &Core::part_there, close).then(idle);
    idle.then(watch);
    close.when("gripped", &Core::gripped, hold).then(pace);
    pace.then(close);
    hold.then(held);
    held.then(open);
    open.then(opening);
    opening.then(watch);
    return mauve::ok();
  }
};

}  // namespace gripper
