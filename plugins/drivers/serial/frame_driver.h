// SPDX-License-Identifier: LGPL-3.0-or-later
/// The common part of drivers of devices that send frames on a serial line: the contract, the state
/// machine (paper 5.2, Fig. 12), and the reading.
#pragma once

#include <mauve/plugin.h>
#include <mauve/serial/device_line.h>

#include <cstdint>
#include <string>

#include "../../types/reporting.h"
#include "../../types/silence.h"
#include "damaged.h"

namespace drivers {

/// Look for the beginning of a frame, read it, parse it; each step may fail.
template <typename ShellT>
class FrameCore : public mauve::Core<ShellT> {
 public:
  virtual void find_sync() = 0;   // [rt] state read_sync
  virtual bool synced() = 0;      // a frame has begun
  virtual void read_frame() = 0;  // [rt] state read_frame
  virtual bool has_frame() = 0;   // a frame is complete and undamaged
  virtual void parse() = 0;       // [rt] state parse: this frame and all that are there
  virtual bool more() = 0;        // stopped early to keep the job short
  virtual bool lost() = 0;        // the device is gone
  virtual void reopen() = 0;      // [rt] state reopen
};

/// `CoreT` names its waits: kWaitFrame and kPeriod.
template <typename CoreT>
struct FrameFsm : mauve::Fsm<CoreT> {
  using Exec = typename mauve::Fsm<CoreT>::Exec;
  using Sync = typename mauve::Fsm<CoreT>::Sync;

  Exec read_sync{*this, "read_sync", &CoreT::find_sync};
  Exec read_frame{*this, "read_frame", &CoreT::read_frame};
  Exec parse{*this, "parse", &CoreT::parse};
  Exec reopen{*this, "reopen", &CoreT::reopen};
  Sync wait_sync{*this, "wait_sync", mauve::Duration{1'000'000},
                 "before looking for a frame again"};
  Sync wait_frame{*this, "wait_frame", CoreT::kWaitFrame, "for the rest of a frame"};
  Sync wait_device{*this, "wait_device", mauve::Duration{100'000'000},
                   "before opening a lost device again"};
  Sync breathe{*this, "breathe", mauve::Duration{1'000'000},
               "between two jobs when much has piled up"};
  Sync period{*this, "period", CoreT::kPeriod, "of the device"};

  mauve::Status on_configure() override {
    this->start_at(read_sync);
    read_sync.when("lost", &CoreT::lost, reopen)
        .when("synced", &CoreT::synced, read_frame)
        .then(wait_sync);
    wait_sync.then(read_sync);
    read_frame.when("has_frame", &CoreT::has_frame, parse)
        .when("lost", &CoreT::lost, reopen)
        .then(wait_frame);
    wait_frame.then(read_frame);
    parse.when("more", &CoreT::more, breathe).then(period);
    breathe.then(read_sync);
    period.then(read_sync);
    reopen.when("lost", &CoreT::lost, wait_device).then(wait_sync);
    wait_device.then(reopen);
    return mauve::ok();
  }
};

/// A core of the contract `CoreT`, which names its device: kDevice and kBaud. `Line` has the bytes,
/// and the stream (GnssStream, XbusStream) in which frames are found.
template <typename CoreT, typename Line>
class FrameDriver : public CoreT {
 protected:
  using Found = typename decltype(Line::stream)::Event;

  /// Uses the frame that the stream just found. [rt]
  virtual void use(Found found) = 0;
  /// Between two frames: a value that waited for more of them may have waited for too long. [rt]
  virtual void look_at_held() {}
  /// A value of a frame was published. [rt]
  void published() {
    silence_.ended();
    frames_before_ = good_frames;
    bytes_before_ = line_.received;
  }
  /// The frame has no value to publish, for this reason: a literal. [rt]
  template <std::size_t N>
  void gave_nothing(const char (&reason)[N]) {
    silence_.look(reason);
  }
  void count_bad() { count_damaged(bad_frames); }
  /// Counts an undamaged frame whose values cannot be, which is skipped.
  void count_implausible() {
    if (rover::worth_reporting(++implausible)) {
      mauve::log(mauve::LogLevel::warning, "frames with values that cannot be: {} so far",
                 implausible.get());
    }
  }

  mauve::State<Line> state{*this};

 private:
  mauve::serial::DeviceLine line_{*this,
                                  {.device = CoreT::kDevice,
                                   .baud = CoreT::kBaud,
                                   .use = mauve::serial::SerialPort::Use::reading}};
  mauve::Property<int> frames_per_job{
      *this, "frames_per_job", 64, "keeps one job short", {.min = 1, .max = 100'000}};
  mauve::Property<mauve::Duration> half_frame{
      *this, "half_frame", mauve::Duration{5'000'000'000},
      "silence after which the rest of a frame is not waited for"};
  mauve::Observable<std::uint64_t> good_frames{*this, "good_frames", 0, "undamaged"};
  mauve::Observable<std::uint64_t> bad_frames{*this, "bad_frames", 0, "damaged ones, skipped"};
  mauve::Observable<std::uint64_t> implausible{*this, "implausible", 0,
                                               "undamaged, with values that cannot be, skipped"};

  mauve::Status on_configure() override { return line_.open(); }
  void on_cleanup() override { line_.close(state->bytes); }

  void find_sync() override {
    look_for_silence();
    look_at_held();
    do {
      look();
    } while (!synced() && take_byte());
  }
  bool synced() override { return complete_ || state->stream.in_frame(); }

  void read_frame() override {
    if (pull_frame() || line_.silence() < half_frame.get()) return;
    state->stream.drop_begun();
    look();
  }
  bool has_frame() override { return complete_; }

  void parse() override {
    int left = frames_per_job;
    do {
      complete_ = false;
      use(found_);
    } while (--left > 0 && pull_frame());
    more_ = left == 0 || line_.spent();
  }
  bool more() override { return more_; }

  bool lost() override { return line_.lost(); }
  void reopen() override {
    silence_.look("its device is not there");
    if (line_.reopen()) state->stream.drop_begun();
  }

  /// Why nothing was published, as far as no frame tells it.
  void look_for_silence() {
    if (line_.received == bytes_before_) return silence_.look("its device sends nothing");
    if (good_frames == frames_before_) {
      silence_.look("its device sends bytes, and no undamaged frame: look at `baud`");
    }
  }

  /// Reads on to the end of the next undamaged frame; false when it is not there yet.
  bool pull_frame() {
    do {
      look();
    } while (!complete_ && take_byte());
    return complete_;
  }

  /// Looks at all bytes that were read, or as far as the next undamaged frame.
  void look() {
    while (!complete_) {
      found_ = state->stream.next();
      if (found_ == Found::none) return;
      complete_ = found_ != Found::bad;
      if (complete_) {
        ++good_frames;
      } else {
        count_bad();
      }
    }
  }

  bool take_byte() {
    char byte = 0;
    const bool took = line_.take(state->bytes, byte);
    if (took) state->stream.push(byte);
    return took;
  }

  rover::Silence silence_{*this};
  Found found_{};
  bool complete_ = false;  // found_ is a frame that was not used yet
  bool more_ = false;
  std::uint64_t frames_before_ = 0;  // when a value was published last
  std::uint64_t bytes_before_ = 0;
};

}  // namespace drivers
