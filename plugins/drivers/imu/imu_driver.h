// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/imu": shell and contract of an inertial unit on a serial line, with the
/// state machine of the satellite receiver (frame_driver.h). Another protocol is another core of
/// this contract.
#pragma once

#include "../../types/imu.h"
#include "../serial/frame_driver.h"

namespace drivers {

struct ImuShell : mauve::Shell {
  mauve::WritePort<rover::Imu> imu{*this, "imu"};
};

class ImuCore : public FrameCore<ImuShell> {
 public:
  using Contract = ImuCore;
  static constexpr const char* contract = "drivers/imu/1";

  static constexpr std::chrono::milliseconds kWaitFrame{2};
  static constexpr std::chrono::milliseconds kPeriod{10};
  static constexpr const char* kDevice = "/dev/ttyUSB0";
  static constexpr int kBaud = 115'200;
};

using ImuFsm = FrameFsm<ImuCore>;

}  // namespace drivers
