// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/create": shell, contract and state machine of a base that receives
/// velocities and streams the motion of its wheels. Another protocol is another core of this
/// contract.
#pragma once

#include <mauve/plugin.h>

#include "../../types/motion.h"
#include "../../types/pose.h"
#include "../../types/velocity.h"

namespace drivers {

using namespace std::chrono_literals;  // NOLINT: durations of states

struct BaseShell : mauve::Shell {
  /// The wheels obey it, so one port at most may write into its resource.
  mauve::ReadPort<rover::Velocity> command{*this, "command", mauve::Need::required,
                                           mauve::Writers::one};
  mauve::WritePort<rover::Odometry> odometry{*this, "odometry"};
  mauve::WritePort<rover::Pose2D> pose{*this, "pose"};
  mauve::WritePort<rover::Twist> twist{*this, "twist"};
  /// Nothing is written here while all is well: its safe value stops the base when the driver
  /// cannot.
  mauve::WritePort<rover::Velocity> brake{*this, "brake", mauve::Safe{rover::Velocity{}}};
};

/// Begin, then work in every period; either may fail.
class BaseCore : public mauve::Core<BaseShell> {
 public:
  using Contract = BaseCore;
  static constexpr const char* contract = "drivers/base/1";

  virtual void begin() = 0;   // [rt] state begin: makes the base listen and stream
  virtual void work() = 0;    // [rt] state work: odometry in, command out
  virtual bool silent() = 0;  // nothing was heard for too long
  virtual bool lost() = 0;    // the device is gone
  virtual void reopen() = 0;  // [rt] state reopen
};

struct BaseFsm : mauve::Fsm<BaseCore> {
  Exec begin{*this, "begin", &BaseCore::begin};
  Exec work{*this, "work", &BaseCore::work};
  Exec reopen{*this, "reopen", &BaseCore::reopen};
  Sync wait_begin{*this, "wait_begin", 50ms, "until the base obeys"};
  Sync wait_device{*this, "wait_device", 100ms, "before opening a lost device again"};
  Sync period{*this, "period", 15ms, "of the stream"};

  mauve::Status on_configure() override {
    start_at(begin);
    begin.when("lost", &BaseCore::lost, reopen).then(wait_begin);
    wait_begin.then(work);
    work.when("lost", &BaseCore::lost, reopen)
        .when("silent", &BaseCore::silent, begin)
        .then(period);
    period.then(work);
    reopen.when("lost", &BaseCore::lost, wait_device).then(wait_begin);
    wait_device.then(reopen);
    return mauve::ok();
  }
};

}  // namespace drivers
