// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "drivers/hokuyo_scip" of component kind "drivers/hokuyo": a Hokuyo scanner that speaks SCIP
/// 2.0 (scip.h) on a serial device. It is ordered to be quiet (QT), asked for its limits (PP),
/// switched on (BM) and asked for scans without end (MD). One write to port `scan` for each
/// undamaged scan, its time the monotonic clock. Example: mauvectl get laser.core.empty_scans
///
/// A value below DMIN is an error code and becomes the range 0, which is no valid return. A value
/// at or beyond DMAX stays and means that nothing is in sight. A scan of nothing but error codes is
/// published as well and counted in `empty_scans`: the scanner is covered, dazzled or broken.
///
/// A scanner that has not answered for `answer_timeout`, or sends no scan for so long, is asked
/// everything again (timeouts). A device that is not there, or goes away, is opened as soon as it
/// is (back) there (device_errors, reopened; state wait_device meanwhile). The scanner is left
/// switched on when the core goes: its successor in a change reads on.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/job.h>
#include <mauve/serial/device_line.h>

#include "../../types/reporting.h"
#include "../../types/silence.h"
#include "../parts.h"
#include "../serial/damaged.h"
#include "laser_driver.h"
#include "scip.h"

namespace drivers {

/// The state that survives a change: unused bytes, the reply begun, and the number of answered
/// requests.
struct ScannerLine {
  mauve::serial::LineBytes bytes;
  scip::ReplyReader replies;
  scip::Limits limits;
  std::uint32_t asked = 0;  // requests answered so far

  /// Opaque to tools; raise the revision when anything in it changes.
  static constexpr std::string_view type_name = "scanner_line/2";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace {

/// Asked in this order.
constexpr std::array<std::string_view, 4> kRequests{"QT", "PP", "BM", "M"};
constexpr std::uint32_t kLimits = 1;
constexpr std::uint32_t kScans = 3;

class HokuyoScip final : public LaserCore {
  mauve::State<ScannerLine> state{*this};
  mauve::serial::DeviceLine line_{*this, {.device = "/dev/ttyACM0"}};
  mauve::Property<int> characters{
      *this, "characters", 3, "of a range: 3, or 2 up to 4 m on a slow line", {.min = 2, .max = 3}};
  mauve::Property<mauve::Duration> answer_timeout{
      *this, "answer_timeout", 500ms, "silent for so long: ask again", {.min = 1ms, .max = {}}};
  mauve::Property<int> scans_per_job{
      *this, "scans_per_job", 8, "keeps one job short", {.min = 1, .max = 1000}};
  rover::Silence silence{*this};
  mauve::Observable<std::uint64_t> scans{*this, "scans", 0, "published"};
  mauve::Observable<std::uint64_t> empty_scans{*this, "empty_scans", 0, "all of them error codes"};
  mauve::Observable<std::uint64_t> bad_frames{*this, "bad_frames", 0, "damaged replies, skipped"};
  mauve::Observable<std::uint64_t> timeouts{*this, "timeouts", 0, "times it fell silent"};
  mauve::Observable<std::uint64_t> refused{*this, "refused", 0, "requests it did not grant"};
  mauve::Observable<bool> empty{*this, "empty", false, "the last scan was one of error codes"};

  mauve::Status on_configure() override { return line_.open(); }
  void on_cleanup() override { line_.close(state->bytes); }

  void ask() override {
    const mauve::Instant now = mauve::job_time();
    // Started again after a stop: the scans that have piled up meanwhile are too old.
    if (measuring() && waiting_since_ != 0 && silent(now)) state->asked = 0;
    if (measuring()) return;
    failed_ = answered_ = false;
    waiting_since_ = now;
    if (state->asked < kScans) {
      std::array<char, 3> text{};
      std::copy_n(kRequests[state->asked].begin(), 2, text.begin());
      text[2] = '\n';
      line_.send({text.data(), text.size()});
      return;
    }
    const scip::Request request = scip::Request::all(state->limits, characters);
    state->replies.expect(request);
    std::array<char, 16> text{};
    const std::array<char, 15> words = request.text();
    std::copy(words.begin(), words.end(), text.begin());
    text.back() = '\n';
    line_.send({text.data(), text.size()});
  }

  void hear() override {
    while (!answered_ && !failed_ && next() != Event::none) {
      if (event_ == Event::reply && is_answer()) take_answer();
    }
    close_when_silent();
  }
  bool answered() override { return answered_; }
  bool measuring() override { return state->asked > kScans; }

  void read_scan() override {
    answered_ = false;
    has_scan_ = pull_scan();
    if (!has_scan_) close_when_silent();
  }
  bool has_scan() override { return has_scan_; }

  void publish() override {
    int left = scans_per_job;
    do {
      show();
    } while (--left > 0 && pull_scan());
    more_ = left == 0 || line_.spent();
  }
  bool more() override { return more_; }
  bool failed() override { return failed_; }

  bool lost() override { return line_.lost(); }
  void reopen() override {
    silence.look("its device is not there");
    if (line_.reopen()) state->asked = 0;
  }

  using Event = scip::ReplyReader::Event;

  /// The next reply of the scanner, or nothing yet.
  Event next() {
    char byte = 0;
    while (line_.take(state->bytes, byte)) {
      event_ = state->replies.push(byte);
      if (event_ == Event::bad) count_damaged(bad_frames);
      if (event_ != Event::none) return event_;
    }
    return event_ = Event::none;
  }

  bool is_answer() {
    return state->replies.command().substr(0, kRequests[state->asked].size()) ==
           kRequests[state->asked];
  }

  /// "02" in reply to BM: the laser is on already. The reply to QT does not matter.
  void take_answer() {
    const std::string_view status = state->replies.status();
    const bool granted =
        status == "00" || state->asked == 0 || (kRequests[state->asked] == "BM" && status == "02");
    const bool usable = state->asked != kLimits || state->replies.limits().usable();
    if (!granted || !usable) {
      ++refused;
      report_refusal(status);
      state->asked = 0;
      failed_ = true;
      return;
    }
    if (state->asked == kLimits) state->limits = state->replies.limits();
    ++state->asked;
    answered_ = true;
    waiting_since_ = mauve::job_time();
  }

  /// "00" grants a request, "02" finds it granted before, "99" is that of a scan.
  static bool is_error(std::string_view status) {
    return status != "00" && status != "02" && status != "99";
  }

  /// Two characters, of SCIP 2.0 digits. Once, until it sends a scan again.
  void report_refusal(std::string_view status) {
    const auto digit = [&](std::size_t at) { return at < status.size() ? status[at] - '0' : 0; };
    const int number = 10 * digit(0) + digit(1);
    silence.look("its scanner refuses to measure: status {}", number);
    if (refusal_.changed(false)) {
      mauve::log(mauve::LogLevel::warning, "its scanner answers a request with status {}", number);
    }
  }

  /// Reads on to the end of the next undamaged scan; false when it is not there yet.
  bool pull_scan() {
    while (next() != Event::none) {
      if (event_ == Event::reply && is_error(state->replies.status())) {
        report_refusal(state->replies.status());
      }
      if (event_ != Event::scan) continue;
      waiting_since_ = mauve::job_time();
      failed_ = false;
      return true;
    }
    return false;
  }

  void show() {
    const scip::ReplyReader& replies = state->replies;
    empty = scip::blind(state->limits, replies.values());
    if (empty) ++empty_scans;
    sees_.report(!empty, "its scanner sees again", "its scanner sees nothing but error codes");
    silence.ended();
    static_cast<void>(refusal_.changed(true));
    shell().scan.fill([&](rover::LaserScan& scan) {
      scan.time = mauve::to_seconds(mauve::job_time());
      scip::show(replies.request(), state->limits, replies.values(), scan);
    });
    ++scans;
  }

  void close_when_silent() {
    const mauve::Instant now = mauve::job_time();
    if (state->asked == kScans) {
      silence.look("its scanner answers, and sends no undamaged scan");
    } else if (refusal_.is_good()) {
      silence.look("its scanner does not answer");
    }
    if (waiting_since_ == 0) waiting_since_ = now;  // the first job after a change
    if (answered_ || failed_ || !silent(now)) return;
    ++timeouts;
    state->asked = 0;
    failed_ = true;
  }

  bool silent(mauve::Instant now) const {
    return now - waiting_since_ >= answer_timeout.get().count();
  }

  rover::Condition sees_{true};
  rover::Condition refusal_{true};
  Event event_ = Event::none;
  mauve::Instant waiting_since_ = 0;
  bool answered_ = false;
  bool has_scan_ = false;
  bool more_ = false;
  bool failed_ = false;
};

}  // namespace

void declare_hokuyo(mauve::Plugin& plugin) {
  plugin.core<HokuyoScip>("hokuyo_scip");
  plugin.component<LaserShell, LaserFsm>("hokuyo", "hokuyo_scip");
}

}  // namespace drivers
