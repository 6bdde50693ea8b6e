// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/hokuyo": shell, contract and state machine of a scanner that is asked
/// for its scans once and then sends them, in the manner of the paper's Fig. 12. Another protocol
/// is another core of this contract.
#pragma once

#include <mauve/plugin.h>

#include "../../types/scan.h"

namespace drivers {

using namespace std::chrono_literals;  // NOLINT: durations of states

struct LaserShell : mauve::Shell {
  mauve::WritePort<rover::LaserScan> scan{*this, "scan"};
};

/// Ask one thing after the other until scans come, then read them; each step may fail.
class LaserCore : public mauve::Core<LaserShell> {
 public:
  using Contract = LaserCore;
  static constexpr const char* contract = "drivers/laser/1";

  virtual void ask() = 0;        // [rt] state ask: the next request
  virtual void hear() = 0;       // [rt] state hear: its answer
  virtual bool answered() = 0;   // ask the next one
  virtual bool measuring() = 0;  // nothing is left to ask
  virtual void read_scan() = 0;  // [rt] state read_scan
  virtual bool has_scan() = 0;   // a scan is complete and undamaged
  virtual void publish() = 0;    // [rt] state publish: this scan and all that are there
  virtual bool more() = 0;       // stopped early to keep the job short
  virtual bool failed() = 0;     // refused or silent: ask everything again
  virtual bool lost() = 0;       // the device is gone
  virtual void reopen() = 0;     // [rt] state reopen
};

struct LaserFsm : mauve::Fsm<LaserCore> {
  Exec ask{*this, "ask", &LaserCore::ask};
  Exec hear{*this, "hear", &LaserCore::hear};
  Exec read_scan{*this, "read_scan", &LaserCore::read_scan};
  Exec publish{*this, "publish", &LaserCore::publish};
  Exec reopen{*this, "reopen", &LaserCore::reopen};
  Sync wait_answer{*this, "wait_answer", 10ms, "for the answer to a request"};
  Sync wait_scan{*this, "wait_scan", 5ms, "for the rest of a scan"};
  Sync wait_device{*this, "wait_device", 100ms, "before opening a lost device again"};
  Sync pause{*this, "pause", 100ms, "before asking everything again"};
  Sync breathe{*this, "breathe", 1ms, "between two jobs when much has piled up"};
  Sync period{*this, "period", 10ms, "after a scan; shorter than a turn of the scanner"};

  mauve::Status on_configure() override {
    start_at(ask);
    ask.when("measuring", &LaserCore::measuring, breathe)
        .when("lost", &LaserCore::lost, reopen)
        .then(wait_answer);
    wait_answer.then(hear);
    hear.when("lost", &LaserCore::lost, reopen)
        .when("failed", &LaserCore::failed, pause)
        .when("measuring", &LaserCore::measuring, read_scan)
        .when("answered", &LaserCore::answered, ask)
        .then(wait_answer);
    pause.then(ask);
    read_scan.when("lost", &LaserCore::lost, reopen)
        .when("has_scan", &LaserCore::has_scan, publish)
        .when("failed", &LaserCore::failed, pause)
        .then(wait_scan);
    wait_scan.then(read_scan);
    publish.when("more", &LaserCore::more, breathe).then(period);
    breathe.then(read_scan);
    period.then(read_scan);
    reopen.when("lost", &LaserCore::lost, wait_device).then(pause);
    wait_device.then(reopen);
    return mauve::ok();
  }
};

}  // namespace drivers
