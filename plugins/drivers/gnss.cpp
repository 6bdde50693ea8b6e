// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "drivers/gnss_nmea" of component kind "drivers/gnss": NMEA 0183 from a serial device. One
/// write to port `fix` for each undamaged GGA sentence; damaged sentences are counted and skipped.
/// Example: mauvectl watch fix.read gnss.core.bad_frames
///
/// One job reads every complete sentence that is there, up to `frames_per_job` and 16 KiB. The
/// device is opened when the core is configured. When it goes away it is closed and opened again as
/// soon as it is back (observables device_errors, reopened; state wait_device meanwhile).
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "gnss_driver.h"
#include "nmea_fix.h"
#include "nmea_frame.h"
#include "parts.h"
#include "serial_port.h"

namespace drivers {

/// What survives a change: bytes read and not used yet, and the sentence begun.
struct GnssLine {
  FrameReader frames;
  FixReader fixes;
  std::array<char, 1024> bytes{};
  std::size_t next = 0;
  std::size_t end = 0;
};

}  // namespace drivers

/// Opaque to tools; raise the revision when anything in it changes.
template <>
struct mauve::Described<drivers::GnssLine> {
  static constexpr std::string_view name = "gnss_line/1";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace drivers {
namespace {

class GnssNmea final : public GnssCore {
  mauve::State<GnssLine> state{*this};
  mauve::Property<std::string> device{*this, "device", "/dev/ttyACM0",
                                      "serial device, or pty:NAME of a simulated receiver"};
  mauve::Property<int> baud{*this,
                            "baud",
                            9600,
                            "speed of the line; 0 leaves it alone",
                            {.unit = "1/s", .min = 0, .max = 921'600}};
  mauve::Property<int> frames_per_job{
      *this, "frames_per_job", 64, "keeps one job short", {.min = 1, .max = 100'000}};
  mauve::Observable<std::uint64_t> good_frames{*this, "good_frames", 0, "undamaged sentences"};
  mauve::Observable<std::uint64_t> bad_frames{*this, "bad_frames", 0, "damaged ones, skipped"};
  mauve::Observable<std::uint64_t> fixes{*this, "fixes", 0, "epochs published"};
  mauve::Observable<std::uint64_t> device_errors{*this, "device_errors", 0, "times it went away"};
  mauve::Observable<std::uint64_t> reopened{*this, "reopened", 0, "times it came back"};
  mauve::Observable<int> satellites{*this, "satellites", 0, "used in the last epoch"};
  mauve::Observable<int> mode{*this, "mode", 1, "1 none, 2 two dimensions, 3 three"};

  mauve::Status on_configure() override { return port_.open(device, baud); }
  void on_cleanup() override { port_.close(); }

  void find_sync() override {
    char byte = 0;
    while (!state->frames.in_frame() && take(byte)) count(state->frames.push(byte));
  }
  bool synced() override { return state->frames.in_frame(); }

  void read_frame() override { complete_ = pull_frame(); }
  bool has_frame() override { return complete_; }

  void parse() override {
    int left = frames_per_job;
    do {
      publish();
    } while (--left > 0 && pull_frame());
    more_ = left == 0 || blocks_left_ == 0;
  }
  bool more() override { return more_; }

  bool lost() override { return !port_.is_open(); }
  void reopen() override {
    if (port_.reopen()) ++reopened;
  }

  /// The next byte; false when there is none yet.
  bool take(char& byte) {
    GnssLine& line = *state;
    if (line.next == line.end) {
      if (lost() || !may_read()) return false;
      const std::ptrdiff_t count = port_.read(line.bytes);
      if (count < 0) lose_device();
      line.next = 0;
      line.end = count > 0 ? static_cast<std::size_t>(count) : 0;
      if (line.end == 0) return false;
    }
    byte = line.bytes[line.next++];
    return true;
  }

  void lose_device() {
    ++device_errors;
    port_.close();
  }

  /// A device that never runs dry must not hold up the job: so many blocks, then the rest waits.
  bool may_read() {
    if (const mauve::Instant now = mauve::job_time(); now != job_) {
      job_ = now;
      blocks_left_ = kBlocksPerJob;
    }
    return blocks_left_ > 0 && blocks_left_-- > 0;
  }

  /// Reads on to the end of the next undamaged sentence; false when it is not there yet.
  bool pull_frame() {
    char byte = 0;
    while (take(byte)) {
      if (count(state->frames.push(byte)) == FrameReader::Event::frame) return true;
    }
    return false;
  }

  FrameReader::Event count(FrameReader::Event event) {
    if (event == FrameReader::Event::frame) ++good_frames;
    if (event == FrameReader::Event::bad) ++bad_frames;
    return event;
  }

  void publish() {
    const FixReader::Event event = state->fixes.read(state->frames.frame());
    if (event == FixReader::Event::malformed) ++bad_frames;
    if (event != FixReader::Event::fix) return;
    const rover::GnssFix& fix = state->fixes.fix();
    shell().fix.write(fix);
    ++fixes;
    satellites = fix.satellites;
    mode = fix.mode;
  }

  static constexpr int kBlocksPerJob = 16;

  SerialPort port_;
  mauve::Instant job_ = 0;  // begin of the job that blocks_left_ belongs to
  int blocks_left_ = 0;
  bool complete_ = false;
  bool more_ = false;
};

}  // namespace

void declare_gnss(mauve::Plugin& plugin) {
  plugin.core<GnssNmea>("gnss_nmea");
  plugin.component<GnssShell, GnssFsm>("gnss", "gnss_nmea");
}

}  // namespace drivers
