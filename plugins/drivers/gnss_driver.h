// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/gnss": shell, contract and state machine (paper 5.2, Fig. 12) of a
/// receiver on a serial line. Another receiver's protocol is another core of this contract.
#pragma once

#include <mauve/plugin.h>

#include "../types/gnss.h"

namespace drivers {

using namespace std::chrono_literals;  // NOLINT: durations of states

struct GnssShell : mauve::Shell {
  mauve::WritePort<rover::GnssFix> fix{*this, "fix"};
};

/// Look for the beginning of a frame, read it, parse it; each step may fail.
class GnssCore : public mauve::Core<GnssShell> {
 public:
  using Contract = GnssCore;
  static constexpr const char* contract = "drivers/gnss/2";

  virtual void find_sync() = 0;   // [rt] state read_sync
  virtual bool synced() = 0;      // a frame has begun
  virtual void read_frame() = 0;  // [rt] state read_frame
  virtual bool has_frame() = 0;   // a frame is complete and undamaged
  virtual void parse() = 0;       // [rt] state parse: this frame and all that are there
  virtual bool more() = 0;        // stopped early to keep the job short
  virtual bool lost() = 0;        // the device is gone
  virtual void reopen() = 0;      // [rt] state reopen
};

struct GnssFsm : mauve::Fsm<GnssCore> {
  Exec read_sync{*this, "read_sync", &GnssCore::find_sync};
  Exec read_frame{*this, "read_frame", &GnssCore::read_frame};
  Exec parse{*this, "parse", &GnssCore::parse};
  Exec reopen{*this, "reopen", &GnssCore::reopen};
  Sync wait_sync{*this, "wait_sync", 1ms, "before looking for a frame again"};
  Sync wait_frame{*this, "wait_frame", 10ms, "for the rest of a frame"};
  Sync wait_device{*this, "wait_device", 100ms, "before opening a lost device again"};
  Sync breathe{*this, "breathe", 1ms, "between two jobs when much has piled up"};
  Sync period{*this, "period", 100ms, "of the receiver"};

  mauve::Status on_configure() override {
    start_at(read_sync);
    read_sync.when(&GnssCore::lost, reopen).when(&GnssCore::synced, read_frame).then(wait_sync);
    wait_sync.then(read_sync);
    read_frame.when(&GnssCore::has_frame, parse).when(&GnssCore::lost, reopen).then(wait_frame);
    wait_frame.then(read_frame);
    parse.when(&GnssCore::more, breathe).then(period);
    breathe.then(read_sync);
    period.then(read_sync);
    reopen.when(&GnssCore::lost, wait_device).then(wait_sync);
    wait_device.then(reopen);
    return mauve::ok();
  }
};

}  // namespace drivers
