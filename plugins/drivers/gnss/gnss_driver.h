// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/gnss": shell and contract of a receiver on a serial line; the state
/// machine is that of the paper's Fig. 12 (frame_driver.h). Another receiver's protocol is another
/// core of this contract.
#pragma once

#include "../../types/gnss.h"
#include "../serial/frame_driver.h"

namespace drivers {

struct GnssShell : mauve::Shell {
  mauve::WritePort<rover::GnssFix> fix{*this, "fix"};
};

class GnssCore : public FrameCore<GnssShell> {
 public:
  using Contract = GnssCore;
  static constexpr const char* contract = "drivers/gnss/2";

  static constexpr std::chrono::milliseconds kWaitFrame{10};
  static constexpr std::chrono::milliseconds kPeriod{100};
  static constexpr const char* kDevice = "/dev/ttyACM0";
  static constexpr int kBaud = 9600;
};

using GnssFsm = FrameFsm<GnssCore>;

}  // namespace drivers
