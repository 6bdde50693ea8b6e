// SPDX-License-Identifier: LGPL-3.0-or-later
/// The gripper on a simulated clock: the test of it, and the program that prints its timeline.
#pragma once

#include <mauve/test_kit.h>

#include "gripper.h"

/// A part comes after 100 ms and stays; the force is ten times the current.
class Gripping : public mauve::ComponentBench<gripper::Shell, gripper::Core, gripper::Fsm> {
 public:
  void run(mauve::Duration duration) {
    constexpr mauve::Duration kStep = 5ms;
    for (; duration >= kStep; duration -= kStep, now_ += kStep) {
      ports().give(shell().part, now_ >= mauve::Duration{100ms});
      ports().give(shell().force, 10.0 * *core().current);
      run_for(kStep);
    }
  }

 private:
  mauve::Duration now_{0};
};
